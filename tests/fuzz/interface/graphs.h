// SPDX-License-Identifier: GPL-3.0-or-later
// Random graphs of every kind of node that the library knows.
#pragma once

#include "dice.h"
#include "specula/specula.h"

#include <deque>
#include <string>

namespace spc::fuzz {

// What spc_node_kinds() says of one.
struct Socket {
    std::string name, type;
};
struct Option {
    std::string name;
    std::vector<std::string> choices;
};
struct Array {
    std::string name;
    uint32_t columns;
};
struct Kind {
    std::string name;
    std::vector<Socket> inputs, outputs;
    std::vector<Option> options;
    std::vector<Array> arrays;
    bool reads_image = false;
};
const std::vector<Kind>& all_kinds();

// A material with the storage for what it points to.
struct Graph {
    std::deque<std::string> texts;
    std::vector<spc_node> nodes;
    std::vector<spc_node_input> inputs;
    std::vector<spc_node_option> options;
    std::deque<std::vector<float>> tables;
    std::vector<spc_node_array> arrays;
    std::vector<spc_node_link> links;
    spc_material_desc desc{};
};

enum class Purpose { surface, world };
// Images are those below `images`. Right but for what the spoiler does to it.
Graph random_graph(Dice& dice, Spoiler& spoiler, uint32_t images, Purpose purpose);

}  // namespace spc::fuzz

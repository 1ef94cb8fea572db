// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/node_table.h"

#include <vector>

#include "shading/graph.h"
#include "shading/node_rows.h"

#include <fmt/format.h>

namespace spc {
namespace {

std::string table_text() {
    std::string text;
    for (const NodeKind& kind : node_table()) {
        text += std::string(kind.name) + ":";
        for (const InputSocket& s : kind.inputs)
            text += std::string(" in ") + s.name + ":" + type_name(s.type);
        for (const OutputSocket& s : kind.outputs)
            text += std::string(" out ") + s.name + ":" + type_name(s.type);
        for (const NodeOption& o : kind.options)
            text += std::string(" option ") + o.name + "=" + (*o.values != '\0' ? o.values : "TEXT");
        for (const NodeArray& a : kind.arrays)
            text += fmt::format(" array {}:{}", a.name, a.columns);
        if (kind.reads_image) text += " image";
        text += "\n";
    }
    return text;
}

}  // namespace

const char* type_name(SocketType type) {
    using enum SocketType;
    switch (type) {
        case scalar: return "float";
        case color: return "color";
        case vector: return "vector";
        case shader: return "shader";
    }
    return "";
}

int choice_of(std::string_view choices, std::string_view value) {
    for (int i = 0;; ++i) {
        const size_t bar = choices.find('|');
        if (choices.substr(0, bar) == value) return i;
        if (bar == std::string_view::npos) return -1;
        choices.remove_prefix(bar + 1);
    }
}

std::span<const NodeKind> node_table() {
    static const std::vector<NodeKind> table = [] {
        std::vector<NodeKind> all;
        for (const auto part : {rows::surface(), rows::volume(), rows::value(), rows::input(),
                                rows::converter(), rows::texture()})
            all.insert(all.end(), part.begin(), part.end());
        return all;
    }();
    return table;
}

const char* node_kinds_text() {
    static const std::string text = table_text();
    return text.c_str();
}

}  // namespace spc

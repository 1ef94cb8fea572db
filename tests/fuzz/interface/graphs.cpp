// SPDX-License-Identifier: GPL-3.0-or-later
#include "graphs.h"

#include <sstream>

namespace spc::fuzz {
namespace {

std::vector<std::string> split(const std::string& text, char at) {
    std::vector<std::string> parts;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, at);) parts.push_back(part);
    return parts;
}

Socket to_socket(const std::string& text) {
    const size_t colon = text.rfind(':');
    return {text.substr(0, colon), text.substr(colon + 1)};
}

// `kind: in Socket:type ... out Socket:type ... option name=A|B ... array name:COLUMNS ... image`
Kind to_kind(const std::string& line) {
    const size_t colon = line.find(':');
    Kind kind;
    kind.name = line.substr(0, colon);
    std::string keyword, text;
    const auto finish = [&] {
        if (keyword == "in") kind.inputs.push_back(to_socket(text));
        if (keyword == "out") kind.outputs.push_back(to_socket(text));
        if (keyword == "option") {
            const size_t equals = text.find('=');
            kind.options.push_back({text.substr(0, equals), split(text.substr(equals + 1), '|')});
        }
        if (keyword == "array") {
            const Socket array = to_socket(text);
            kind.arrays.push_back({array.name, static_cast<uint32_t>(std::stoul(array.type))});
        }
        kind.reads_image = kind.reads_image || keyword == "image";
        text.clear();
    };
    for (const std::string& word : split(line.substr(colon + 2), ' ')) {
        if (word == "in" || word == "out" || word == "option" || word == "array" ||
            word == "image") {
            finish();
            keyword = word;
        } else {
            text += (text.empty() ? "" : " ") + word;
        }
    }
    finish();
    return kind;
}

class Grower {
public:
    Grower(Dice& dice, Spoiler& spoiler, uint32_t images, Purpose purpose)
        : dice_(dice), spoiler_(spoiler), images_(images), purpose_(purpose) {}

    Graph grow() {
        const Kind& output = *find([](const Kind& kind) { return kind.name == "output"; });
        graph_.nodes.push_back({"Output", text(output.name), SPC_NONE});
        if (purpose_ == Purpose::world || !dice_.chance(0.05)) link_to(0, "Surface", "shader", 0);
        if (purpose_ == Purpose::surface && dice_.chance(0.1)) link_to(0, "Volume", "volume", 0);
        spoil();
        return std::move(graph_);
    }

private:
    static constexpr uint32_t kDeepest = 4;

    const char* text(const std::string& of) { return graph_.texts.emplace_back(of).c_str(); }

    template <class Fits>
    const Kind* find(const Fits& fits) {
        std::vector<const Kind*> found;
        for (const Kind& kind : all_kinds())
            if (fits(kind)) found.push_back(&kind);
        return found.empty() ? nullptr : dice_.one_of(found);
    }

    // Whether a node of this kind may stand before a socket of this type.
    bool suits(const Kind& kind, const std::string& type, uint32_t depth) const {
        if (kind.outputs.empty() || (kind.reads_image && images_ == 0)) return false;
        const bool shader = kind.outputs[0].type == "shader";
        const bool volume = kind.outputs[0].name == "Volume";
        const bool mixes = kind.name == "mix_shader" || kind.name == "add_shader";
        if (mixes && depth >= kDeepest) return false;
        if (type == "volume") return volume || mixes;
        if (type != "shader") return !shader;
        if (purpose_ == Purpose::world) return kind.name == "background" || mixes;
        return shader && !volume && kind.name != "background";
    }

    void link_to(uint32_t node, const std::string& socket, const std::string& type, uint32_t depth) {
        const Kind* kind = find([&](const Kind& k) { return suits(k, type, depth); });
        if (kind == nullptr) return;
        const uint32_t from = add(*kind, type, depth + 1);
        graph_.links.push_back({from, text(dice_.one_of(kind->outputs).name), node, text(socket)});
    }

    uint32_t add(const Kind& kind, const std::string& type, uint32_t depth) {
        const auto index = static_cast<uint32_t>(graph_.nodes.size());
        const uint32_t image = kind.reads_image ? dice_.below(images_) : SPC_NONE;
        graph_.nodes.push_back({text("Node " + std::to_string(index)), text(kind.name), image});
        for (const Socket& socket : kind.inputs) {
            if (socket.type == "shader") {
                link_to(index, socket.name, type, depth);
                continue;
            }
            const bool by_link_alone = socket.type == "vector" && kind.name != "mapping";
            if (depth < kDeepest && dice_.chance(by_link_alone ? 0.25 : 0.08))
                link_to(index, socket.name, socket.type, depth);
            else if (!by_link_alone && dice_.chance(0.6))
                graph_.inputs.push_back({index, text(socket.name), {}}), fill(graph_.inputs.back());
        }
        for (const Option& option : kind.options)
            if (dice_.chance(0.5))
                graph_.options.push_back(
                    {index, text(option.name), text(dice_.one_of(option.choices))});
        for (const Array& array : kind.arrays) {
            std::vector<float>& table =
                graph_.tables.emplace_back(array.columns * (2 + dice_.below(6)));
            for (float& value : table) value = spoiler_.number(dice_.between(0.0f, 1.2f));
            graph_.arrays.push_back(
                {index, text(array.name), table.data(), static_cast<uint32_t>(table.size())});
        }
        return index;
    }

    void fill(spc_node_input& input) {
        const bool smooth = std::string(input.socket).find("oughness") != std::string::npos;
        for (float& value : input.value) {
            value = smooth && dice_.chance(0.5) ? 0.0f : dice_.between(0.0f, 1.2f);
            value = spoiler_.number(value);
        }
    }

    // What is wrong with the graph itself.
    void spoil() {
        for (spc_node& node : graph_.nodes) {
            if (spoiler_.strikes() && dice_.chance(0.2)) node.image = spoiler_.count(node.image);
            node.kind = spoiler_.pointer(node.kind);
            node.name = spoiler_.pointer(node.name);
        }
        const auto nodes = static_cast<uint32_t>(graph_.nodes.size());
        for (spc_node_link& link : graph_.links) {
            if (spoiler_.strikes() && dice_.chance(0.2)) link.from_node = dice_.below(nodes + 1);
            if (spoiler_.strikes() && dice_.chance(0.2)) link.to_node = dice_.below(nodes + 1);
            link.to_socket = spoiler_.pointer(link.to_socket);
        }
        for (spc_node_input& input : graph_.inputs) {
            if (spoiler_.strikes() && dice_.chance(0.2)) input.node = dice_.below(nodes + 1);
            input.socket = spoiler_.pointer(input.socket);
        }
        for (spc_node_option& option : graph_.options)
            option.value = spoiler_.pointer(option.value);
        for (spc_node_array& array : graph_.arrays) {
            if (spoiler_.strikes() && dice_.chance(0.2)) array.node = dice_.below(nodes + 1);
            if (spoiler_.strikes() && dice_.chance(0.2)) array.count = dice_.below(array.count);
            array.values = spoiler_.pointer(array.values);
        }
        if (spoiler_.strikes() && !graph_.links.empty() && dice_.chance(0.2))
            graph_.links.push_back(dice_.one_of(graph_.links));
    }

    Dice& dice_;
    Spoiler& spoiler_;
    uint32_t images_;
    Purpose purpose_;
    Graph graph_;
};

}  // namespace

const std::vector<Kind>& all_kinds() {
    static const std::vector<Kind> kinds = [] {
        std::vector<Kind> parsed;
        for (const std::string& line : split(spc_node_kinds(), '\n'))
            if (!line.empty()) parsed.push_back(to_kind(line));
        return parsed;
    }();
    return kinds;
}

Graph random_graph(Dice& dice, Spoiler& spoiler, uint32_t images, Purpose purpose) {
    Graph graph = Grower(dice, spoiler, images, purpose).grow();
    spc_material_desc& desc = graph.desc;
    desc.struct_size = spoiler.struct_size(sizeof(desc));
    desc.name = "Varnish";
    desc.nodes = spoiler.pointer(graph.nodes.data());
    desc.node_count = static_cast<uint32_t>(graph.nodes.size());
    desc.inputs = graph.inputs.data();
    desc.input_count = static_cast<uint32_t>(graph.inputs.size());
    desc.options = graph.options.data();
    desc.option_count = static_cast<uint32_t>(graph.options.size());
    desc.arrays = graph.arrays.data();
    desc.array_count = static_cast<uint32_t>(graph.arrays.size());
    desc.links = graph.links.data();
    desc.link_count = static_cast<uint32_t>(graph.links.size());
    desc.glints = spoiler.count(dice.below(3));
    desc.bump_correction = spoiler.count(dice.below(3));
    return graph;
}

}  // namespace spc::fuzz

// SPDX-License-Identifier: GPL-3.0-or-later
#include "shading/resolve.h"

#include "core/error.h"

#include <fmt/format.h>

namespace spc {
namespace {

[[noreturn]] void fail(const std::string& message) {
    throw Error(ErrorKind::invalid_argument, message);
}

template <class Item>
int find(std::span<const Item> items, std::string_view name) {
    for (size_t i = 0; i < items.size(); ++i)
        if (items[i].name == name) return static_cast<int>(i);
    return -1;
}

template <class Item>
std::string names_of(std::span<const Item> items) {
    if (items.empty()) return "none";
    std::string text(items.front().name);
    for (const Item& item : items.subspan(1)) text.append(", ").append(item.name);
    return text;
}

class Resolver {
public:
    Resolver(const Graph& graph, size_t image_count) : graph_(graph), image_count_(image_count) {}

    ResolvedGraph run() {
        result_.name = graph_.name;
        for (const GraphNode& node : graph_.nodes) add_node(node);
        if (result_.output == kNone) fail(material() + ": has no output node");
        for (const GraphInput& input : graph_.inputs) add_input(input);
        for (const GraphOption& option : graph_.options) add_option(option);
        for (const GraphArray& array : graph_.arrays) add_array(array);
        for (const GraphLink& link : graph_.links) add_link(link);
        refuse_cycles();
        find_live();
        return std::move(result_);
    }

private:
    std::string material() const { return named("material", graph_.name); }
    std::string at(uint32_t node, std::string_view socket = {}) const {
        return where(graph_.name, graph_.nodes[node], socket);
    }

    void add_node(const GraphNode& node) {
        const std::span<const NodeKind> table = node_table();
        const int kind = find(table, node.kind);
        if (kind < 0) fail(where(graph_.name, node) + ": unknown kind \"" + node.kind + "\"");
        ResolvedNode resolved;
        resolved.graph = &node;
        resolved.kind = &table[static_cast<size_t>(kind)];
        resolved.inputs.resize(resolved.kind->inputs.size());
        resolved.used_outputs.resize(resolved.kind->outputs.size());
        resolved.arrays.resize(resolved.kind->arrays.size());
        for (const NodeOption& option : resolved.kind->options) {
            const std::string_view values = option.values;
            resolved.options.emplace_back(values.substr(0, values.find('|')));
        }
        if (node.image != kNone && node.image >= image_count_)
            fail(where(graph_.name, node) + ": image " + std::to_string(node.image) + " of " +
                 std::to_string(image_count_));
        if (resolved.kind->name == std::string_view("output")) {
            if (result_.output != kNone)
                fail(where(graph_.name, node) + ": a second output beside \"" +
                     graph_.nodes[result_.output].name + "\"");
            result_.output = static_cast<uint32_t>(result_.nodes.size());
        }
        if (resolved.kind->name == std::string_view("aov_output"))
            result_.aovs.push_back(static_cast<uint32_t>(result_.nodes.size()));
        result_.nodes.push_back(std::move(resolved));
    }

    ResolvedNode& node_at(uint32_t index, const char* what) {
        if (index >= result_.nodes.size())
            fail(material() + ": " + what + " of node " + std::to_string(index) + " of " +
                 std::to_string(result_.nodes.size()));
        return result_.nodes[index];
    }
    int input_at(const ResolvedNode& node, uint32_t index, const std::string& socket) const {
        const int i = find(node.kind->inputs, socket);
        if (i < 0)
            fail(at(index, socket) + ": no such input of " + node.kind->name +
                 " (has: " + names_of(node.kind->inputs) + ")");
        return i;
    }

    void add_input(const GraphInput& input) {
        ResolvedNode& node = node_at(input.node, "an input");
        const size_t i = static_cast<size_t>(input_at(node, input.node, input.socket));
        const InputSocket& socket = node.kind->inputs[i];
        if (socket.type == SocketType::shader || socket.unlinked != Unlinked::constant)
            fail(at(input.node, input.socket) + ": takes a link, not a constant");
        if (node.inputs[i].given) fail(at(input.node, input.socket) + ": two constants");
        const size_t lanes = socket.type == SocketType::scalar ? 1 : 3;
        for (size_t k = 0; k < lanes; ++k) {
            if (!std::isfinite(input.value[k])) fail(at(input.node, input.socket) + ": not finite");
            node.inputs[i].value[k] = input.value[k];
        }
        node.inputs[i].given = true;
    }

    void add_option(const GraphOption& option) {
        ResolvedNode& node = node_at(option.node, "an option");
        const int i = find(node.kind->options, option.option);
        if (i < 0)
            fail(fmt::format("{}, option \"{}\": no such option of {} (has: {})", at(option.node),
                             option.option, node.kind->name, names_of(node.kind->options)));
        const std::string_view values = node.kind->options[static_cast<size_t>(i)].values;
        if (!values.empty() && choice_of(values, option.value) < 0)
            fail(fmt::format("{}, option \"{}\": \"{}\" is not one of {}", at(option.node),
                             option.option, option.value, values));
        node.options[static_cast<size_t>(i)] = option.value;
    }

    void add_array(const GraphArray& array) {
        ResolvedNode& node = node_at(array.node, "an array");
        const auto fail_at = [&](const std::string& what) {
            fail(fmt::format("{}, array \"{}\": {}", at(array.node), array.name, what));
        };
        const int i = find(node.kind->arrays, array.name);
        if (i < 0)
            fail_at(fmt::format("no such array of {} (has: {})", node.kind->name,
                                names_of(node.kind->arrays)));
        const size_t columns = node.kind->arrays[static_cast<size_t>(i)].columns,
                     count = array.values.size();
        if (count % columns != 0 || count < 2 * columns)
            fail_at(fmt::format("{} numbers; {} in each of at least two rows", count, columns));
        for (const float value : array.values)
            if (!std::isfinite(value)) fail_at("not finite");
        if (node.arrays[static_cast<size_t>(i)] != nullptr) fail_at("given twice");
        node.arrays[static_cast<size_t>(i)] = &array.values;
    }

    void add_link(const GraphLink& link) {
        const ResolvedNode& from = node_at(link.from_node, "a link");
        ResolvedNode& to = node_at(link.to_node, "a link");
        const int output = find(from.kind->outputs, link.from_socket);
        if (output < 0)
            fail(at(link.from_node, link.from_socket) + ": no such output of " + from.kind->name +
                 " (has: " + names_of(from.kind->outputs) + ")");
        const int input = input_at(to, link.to_node, link.to_socket);
        const SocketType from_type = from.kind->outputs[static_cast<size_t>(output)].type;
        const SocketType to_type = to.kind->inputs[static_cast<size_t>(input)].type;
        if (from_type == SocketType::shader && to_type != SocketType::shader)
            fail(at(link.to_node, link.to_socket) + ": a shader is linked to a " +
                 type_name(to_type));
        ResolvedInput& resolved = to.inputs[static_cast<size_t>(input)];
        if (resolved.from_node != kNone) fail(at(link.to_node, link.to_socket) + ": two links");
        resolved.from_node = link.from_node;
        resolved.from_output = output;
    }

    // Removes nodes that nothing reads any more until none is left; what stays lies on a cycle or
    // feeds one.
    void refuse_cycles() const {
        std::vector<uint32_t> readers(result_.nodes.size()), ready;
        for (const ResolvedNode& node : result_.nodes)
            for (const ResolvedInput& input : node.inputs)
                if (input.from_node != kNone) ++readers[input.from_node];
        for (uint32_t i = 0; i < readers.size(); ++i)
            if (readers[i] == 0) ready.push_back(i);
        for (size_t k = 0; k < ready.size(); ++k)
            for (const ResolvedInput& input : result_.nodes[ready[k]].inputs)
                if (input.from_node != kNone && --readers[input.from_node] == 0)
                    ready.push_back(input.from_node);
        if (ready.size() == readers.size()) return;
        for (uint32_t i = 0; i < readers.size(); ++i) {
            if (readers[i] == 0) continue;
            const std::vector<ResolvedInput>& inputs = result_.nodes[i].inputs;
            for (size_t k = 0; k < inputs.size(); ++k)
                if (inputs[k].from_node != kNone && readers[inputs[k].from_node] > 0)
                    fail(at(i, result_.nodes[i].kind->inputs[k].name) + ": its links form a cycle");
        }
    }

    void find_live() {
        std::vector<uint32_t> reached{result_.output}, readers(result_.nodes.size());
        reached.insert(reached.end(), result_.aovs.begin(), result_.aovs.end());
        result_.order = reached;
        for (const uint32_t root : reached) result_.nodes[root].live = true;
        for (size_t k = 0; k < reached.size(); ++k) {
            for (const ResolvedInput& input : result_.nodes[reached[k]].inputs) {
                if (input.from_node == kNone) continue;
                ResolvedNode& from = result_.nodes[input.from_node];
                from.used_outputs[static_cast<size_t>(input.from_output)] = true;
                ++readers[input.from_node];
                if (!from.live) reached.push_back(input.from_node);
                from.live = true;
            }
        }
        for (size_t k = 0; k < result_.order.size(); ++k)
            for (const ResolvedInput& input : result_.nodes[result_.order[k]].inputs)
                if (input.from_node != kNone && --readers[input.from_node] == 0)
                    result_.order.push_back(input.from_node);
        for (uint32_t i : result_.order) {
            const ResolvedNode& node = result_.nodes[i];
            if (node.kind->reads_image && node.graph->image == kNone)
                fail(at(i) + ": has no image");
            for (size_t k = 0; k < node.arrays.size(); ++k)
                if (node.arrays[k] == nullptr && !node.kind->arrays[k].optional)
                    fail(fmt::format("{}, array \"{}\": missing", at(i), node.kind->arrays[k].name));
        }
    }

    const Graph& graph_;
    size_t image_count_;
    ResolvedGraph result_;
};

}  // namespace

std::string where(const std::string& material, const GraphNode& node, std::string_view socket) {
    std::string text = named("material", material) + ", " +
                       named("node", node.name.empty() ? node.kind : node.name);
    if (!socket.empty()) text += ", socket \"" + std::string(socket) + "\"";
    return text;
}

ResolvedGraph resolve(const Graph& graph, size_t image_count) {
    return Resolver(graph, image_count).run();
}

}  // namespace spc

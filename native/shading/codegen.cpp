// SPDX-License-Identifier: GPL-3.0-or-later
// From expressions to instructions: order, constants, registers.
#include "core/error.h"
#include "shading/compiler.h"

namespace spc {
namespace {

constexpr uint32_t kForever = 0xffffffffu;

class Generator {
public:
    Generator(const ExprBuilder& expr, const std::string& material)
        : expr_(expr), material_(material) {}

    // Appends what `roots` need; operand() gives their places until the next section begins.
    Section section(const std::vector<ExprId>& roots) {
        const std::vector<ExprId> order = depth_first(roots);
        find_last_uses(order, roots);
        registers_.clear();
        in_use_.fill(false);
        Section result;
        result.begin = static_cast<uint32_t>(program_.instructions.size());
        for (uint32_t k = 0; k < order.size(); ++k) emit(order[k], k);
        result.end = static_cast<uint32_t>(program_.instructions.size());
        return result;
    }

    Section section(ExprId root) {
        if (root == kNoExpr) return {};
        Section result = section(std::vector<ExprId>{root});
        result.result = operand(root);
        return result;
    }

    Operand operand(ExprId id) {
        if (id == kNoExpr) return kNoOperand;
        if (!expr_.is_constant(id)) return registers_.at(id);
        const auto [known, added] = constants_.try_emplace(id);
        if (added) {
            const std::array<float, 4>& value = expr_[id].value;
            const size_t lanes = expr_.lanes(id);
            if (program_.constants.size() + lanes > size_t{INT16_MAX}) fail("constants", INT16_MAX);
            known->second = static_cast<Operand>(~static_cast<int>(program_.constants.size()));
            program_.constants.insert(program_.constants.end(), value.begin(),
                                      value.begin() + lanes);
        }
        return known->second;
    }

    // Appends the operands of an instruction or closure; where they begin.
    uint32_t operands(const std::vector<ExprId>& in) {
        const auto begin = static_cast<uint32_t>(program_.operands.size());
        for (const ExprId id : in) program_.operands.push_back(operand(id));
        return begin;
    }

    // The heights of all bumps so far. Derivatives are taken of them, up to the second: what
    // interpolates does so smoothly.
    void append_heights() {
        smooth_ = true;
        for (const ExprId height : heights_) program_.heights.push_back(section(height));
    }

    Program take() { return std::move(program_); }
    void add(const ClosureInstruction& closure) { program_.closures.push_back(closure); }

private:
    [[noreturn]] void fail(const char* what, int limit) const {
        throw Error(ErrorKind::invalid_argument, "material \"" + material_ + "\": needs more " +
                                                     what + " than " + std::to_string(limit));
    }

    // A lane lives in the registers of what it is a lane of.
    ExprId owner(ExprId id) const { return expr_[id].op == Op::lane ? expr_[id].in[0] : id; }
    int width(ExprId id) const { return traits(expr_[id].op).has_fourth ? 4 : expr_.lanes(id); }

    // Each value right before its first user, so that few live at a time. With a stack of its own:
    // chains may be long.
    std::vector<ExprId> depth_first(const std::vector<ExprId>& roots) const {
        std::vector<ExprId> order, stack;
        std::vector<bool> done;
        const auto is_done = [&](ExprId id) {
            if (id == kNoExpr || expr_.is_constant(id)) return true;
            if (done.size() <= static_cast<size_t>(id)) done.resize(static_cast<size_t>(id) + 1);
            return bool(done[static_cast<size_t>(id)]);
        };
        for (ExprId root : roots) {
            if (!is_done(root)) stack.push_back(root);
            while (!stack.empty()) {
                const ExprId id = stack.back();
                const std::vector<ExprId>& in = expr_[id].in;
                const auto pending = std::find_if_not(in.begin(), in.end(), is_done);
                if (pending != in.end()) {
                    stack.push_back(*pending);
                    continue;
                }
                stack.pop_back();
                done[static_cast<size_t>(id)] = true;
                order.push_back(id);
            }
        }
        return order;
    }

    void find_last_uses(const std::vector<ExprId>& order, const std::vector<ExprId>& roots) {
        last_use_.clear();
        for (uint32_t k = 0; k < order.size(); ++k)
            for (ExprId in : expr_[order[k]].in)
                if (in != kNoExpr) last_use_[owner(in)] = k;
        for (ExprId root : roots)
            if (root != kNoExpr) last_use_[owner(root)] = kForever;
    }

    Operand allocate(int count) {
        for (int i = 0, run = 0; i < kMaxRegisters; ++i) {
            run = in_use_[static_cast<size_t>(i)] ? 0 : run + 1;
            if (run < count) continue;
            const int begin = i + 1 - count;
            mark(begin, count, true);
            return static_cast<Operand>(begin);
        }
        fail("intermediate values", kMaxRegisters);
    }
    void mark(int begin, int count, bool used) {
        for (int i = begin; i < begin + count; ++i) in_use_[static_cast<size_t>(i)] = used;
    }

    void emit(ExprId id, uint32_t position) {
        const Expr& e = expr_[id];
        if (e.op == Op::lane) {
            registers_[id] = static_cast<Operand>(registers_.at(e.in[0]) + e.mode);
            return;
        }
        Instruction i{e.op, e.lanes, e.mode, 0, operands(e.in), e.index};
        const OpTraits& row = traits(e.op);
        if (row.index == IndexOf::block) i.index = block_begin(e.index);
        if (row.index == IndexOf::height) i.index = height_index(static_cast<ExprId>(e.index));
        if (row.interpolates && smooth_) i.mode = with_interpolation(e.mode, Interpolation::cubic);
        // Instructions read all before they write, so that an input read for the last time makes
        // room.
        for (ExprId in : e.in) {
            if (in == kNoExpr || expr_.is_constant(in) || last_use_.at(owner(in)) != position)
                continue;
            mark(registers_.at(owner(in)), width(owner(in)), false);
        }
        registers_[id] = i.out = allocate(width(id));
        program_.instructions.push_back(i);
    }

    uint32_t block_begin(uint32_t block) {
        const auto [known, added] = blocks_.try_emplace(block);
        if (added) {
            const std::vector<float>& values = expr_.block_values(block);
            known->second = static_cast<uint32_t>(program_.blocks.size());
            program_.blocks.insert(program_.blocks.end(), values.begin(), values.end());
        }
        return known->second;
    }

    uint32_t height_index(ExprId height) {
        const auto found = std::find(heights_.begin(), heights_.end(), height);
        const auto index = static_cast<uint32_t>(found - heights_.begin());
        if (found == heights_.end()) heights_.push_back(height);
        return index;
    }

    const ExprBuilder& expr_;
    const std::string& material_;
    Program program_;
    std::vector<ExprId> heights_;
    bool smooth_ = false;
    std::map<ExprId, Operand> constants_, registers_;
    std::map<ExprId, uint32_t> last_use_;
    std::map<uint32_t, uint32_t> blocks_;  // number to place in Program::blocks
    std::array<bool, kMaxRegisters> in_use_{};
};

}  // namespace

Program generate(const ExprBuilder& expr, const std::vector<ClosureTerm>& terms,
                 const ProgramRoots& roots, const std::string& material) {
    Generator generator(expr, material);
    std::vector<ExprId> surface_roots{roots.emission, roots.surface_normal};
    for (const ClosureTerm& term : terms) {
        surface_roots.insert(surface_roots.end(), term.in.begin(), term.in.end());
        surface_roots.insert(
            surface_roots.end(),
            {term.coat.through, term.grain.stretch, term.grain.tangent, term.below.share,
             term.below.radius, term.below.entry, term.film.thickness, term.film.ior});
        if (term.coated_on_slope_map())
            surface_roots.insert(surface_roots.end(), {term.coat.layer, term.coat.tint});
    }
    Section surface = generator.section(surface_roots);
    surface.result = generator.operand(roots.emission);
    const Operand surface_normal = generator.operand(roots.surface_normal);
    for (const ClosureTerm& term : terms) {
        ClosureInstruction closure{term.op, term.modes, term.on_caster_normal, term.on_slope_map};
        closure.operands = generator.operands(term.in);
        closure.through = generator.operand(term.coat.through);
        closure.stretch = generator.operand(term.grain.stretch);
        closure.tangent = generator.operand(term.grain.tangent);
        closure.film_thickness = generator.operand(term.film.thickness);
        closure.film_ior = generator.operand(term.film.ior);
        closure.below_share = generator.operand(term.below.share);
        closure.below_radius = generator.operand(term.below.radius);
        closure.below_entry = generator.operand(term.below.entry);
        if (term.coated_on_slope_map()) {
            closure.coat = generator.operand(term.coat.layer);
            closure.coat_tint = generator.operand(term.coat.tint);
        }
        generator.add(closure);
    }
    const Section emission = generator.section(roots.emission),
                  transparency = generator.section(roots.transparency);
    const Section caster_normal = generator.section(roots.caster_normal),
                  background = generator.section(roots.background),
                  displacement = generator.section(roots.displacement);
    std::vector<Program::Aov> aovs;
    for (const ProgramRoots::Aov& aov : roots.aovs) {
        const Section color = generator.section(aov.color);
        aovs.push_back({color, generator.section(aov.value)});
    }
    generator.append_heights();
    Program program = generator.take();
    program.surface = surface;
    program.surface_normal = surface_normal;
    program.emission = emission;
    program.transparency = transparency;
    program.caster_normal = caster_normal;
    program.background = background;
    program.displacement = displacement;
    program.aovs = std::move(aovs);
    return program;
}

uint32_t reads_of(const Program& program, const Section& section) {
    uint32_t reads = 0;
    for (uint32_t k = section.begin; k < section.end; ++k)
        reads |= traits(program.instructions[k].op).reads;
    return reads;
}

std::vector<uint32_t> images_of(const Program& program) {
    std::vector<uint32_t> images;
    const auto add = [&](uint32_t image) {
        if (std::find(images.begin(), images.end(), image) == images.end()) images.push_back(image);
    };
    for (const Instruction& i : program.instructions) {
        if (traits(i.op).index == IndexOf::image) add(i.index);
        if (i.op != Op::tiled_image) continue;
        const float* block = program.blocks.data() + i.index;
        for (size_t k = 0; k < static_cast<size_t>(*block); ++k)
            add(static_cast<uint32_t>(block[2 * k + 2]));
    }
    return images;
}

}  // namespace spc

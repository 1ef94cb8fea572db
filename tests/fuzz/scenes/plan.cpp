// SPDX-License-Identifier: GPL-3.0-or-later
#include "scenes/plan.h"

#include <fmt/format.h>

namespace spc::fuzz {
namespace {

// Rays of path tracing meet lights that are at least so large, m; of a sun, rad.
constexpr float kFoundByRays = 0.1f;

constexpr const char* kForms[] = {"ball", "faceted ball", "bowl", "pane", "slab", "block", "waves"};
constexpr const char* kFinishes[] = {"mirror", "metal", "glass", "refraction"};
constexpr const char* kDetails[] = {"smooth", "normal map", "bump"};
constexpr const char* kLamps[] = {"point", "spot", "rectangle", "ellipse", "sun", "mesh"};
constexpr const char* kSkies[] = {"no sky", "an even sky", "a sky with a peak"};

template <class E>
auto name_of(E value, const auto& names) {
    return names[static_cast<size_t>(value)];
}
template <class E>
E any(Dice& dice, size_t count) {
    return static_cast<E>(dice.below(count));
}
uint32_t any_visibility(Dice& dice) { return kVisibleAll & ~(1u << dice.below(5)); }

Caster random_caster(Dice& dice, uint32_t index) {
    Caster c;
    c.name = fmt::format("caster{}", index);
    c.form = any<Form>(dice, std::size(kForms));
    c.finish = any<Finish>(dice, std::size(kFinishes));
    if (dice.chance(0.25)) c.roughness = dice.one_of({0.03f, 0.1f, 0.2f, 0.3f, 0.5f});
    c.ior = dice.one_of({1.5f, 1.33f, 1.05f, 2.4f, 0.8f});
    if (dice.chance(0.35)) {
        c.detail = dice.chance(0.7) ? Detail::normal_map : Detail::bump;
        c.texels = dice.one_of({16u, 64u, 256u, 1024u});
        c.wavelength = dice.one_of({0.5f, 0.2f, 0.06f, 0.02f});
        c.slope = dice.one_of({0.01f, 0.05f, 0.2f});
    }
    if (dice.chance(0.2)) c.absorption = dice.one_of({0.3f, 3.0f});
    if (dice.chance(0.1)) c.coat = dice.between(0.2f, 0.8f);
    c.position =
        Vec3(dice.between(-0.8f, 0.8f), dice.between(-0.6f, 0.8f), dice.between(0.1f, 1.2f));
    if (dice.chance(0.6))
        c.turn =
            Vec3(dice.between(-1.6f, 1.6f), dice.between(-0.8f, 0.8f), dice.between(-3.2f, 3.2f));
    c.scale = Vec3(dice.between(0.2f, 0.7f));
    if (dice.chance(0.2)) c.scale.z *= dice.one_of({0.2f, 0.6f, 1.7f});
    c.flipped = dice.chance(0.1);
    c.filled = dice.chance(0.1);
    if (dice.chance(0.15)) c.copies = dice.from(2, 4);
    if (dice.chance(0.1)) c.visibility = any_visibility(dice);
    if (dice.chance(0.15)) c.role = any<CausticsRole>(dice, 5);
    return c;
}

Lamp random_lamp(Dice& dice, uint32_t index) {
    Lamp l;
    l.name = fmt::format("lamp{}", index);
    l.kind = any<LampKind>(dice, std::size(kLamps));
    const float azimuth = dice.between(-kPi, kPi), height = dice.between(1.2f, 3.0f);
    l.position = Vec3(1.5f * std::cos(azimuth), 1.5f * std::sin(azimuth), height);
    l.target = Vec3(dice.between(-0.5f, 0.5f), dice.between(-0.5f, 0.5f), 0.3f);
    const bool tiny = dice.chance(0.25) && l.kind != LampKind::mesh;
    const bool area = l.kind == LampKind::rectangle || l.kind == LampKind::ellipse;
    l.extent = tiny ? (area ? 0.01f : dice.one_of({0.0f, 0.0f, 0.01f})) : dice.between(0.25f, 0.8f);
    if (area && dice.chance(0.4)) l.stretch = dice.one_of({0.5f, 2.0f});
    if (dice.chance(0.3) || l.kind == LampKind::spot) l.beam = dice.between(0.3f, 2.0f);
    l.blend = dice.one_of({0.0f, 0.3f, 1.0f});
    l.soft = dice.chance(0.3);
    l.power = l.kind == LampKind::sun ? 3.0f : dice.one_of({5.0f, 50.0f});
    if (dice.chance(0.15)) l.visibility = any_visibility(dice);
    l.feeds_caustics = !dice.chance(0.05);
    return l;
}

const char* visibility_text(uint32_t visibility) {
    switch (kVisibleAll & ~visibility) {
        case 0: return "";
        case kVisibleCamera: return ", not for the camera";
        case kVisibleDiffuse: return ", not for diffuse rays";
        case kVisibleGlossy: return ", not for glossy rays";
        case kVisibleTransmission: return ", not for transmission rays";
        default: return ", without shadow";
    }
}

std::string text_of(const Vec3& v) {
    return fmt::format("({:.3g}, {:.3g}, {:.3g})", v.x, v.y, v.z);
}

std::string text_of(const Caster& c) {
    std::string text =
        fmt::format("{}: {} of {}, roughness {:.2g}, ior {:.3g}, at {}, turned {}, scale {}",
                    c.name, name_of(c.form, kForms), name_of(c.finish, kFinishes), c.roughness,
                    c.ior, text_of(c.position), text_of(c.turn), text_of(c.scale));
    if (c.detail != Detail::none)
        text += fmt::format(", {} of {} texels, waves of {:.2g} with slope {:.2g}",
                            name_of(c.detail, kDetails), c.texels, c.wavelength, c.slope);
    if (c.absorption > 0.0f) text += fmt::format(", absorbs {:.2g}/m", c.absorption);
    if (c.coat > 0.0f) text += fmt::format(", {:.2g} of it diffuse", c.coat);
    if (c.flipped) text += ", flipped";
    if (c.filled) text += ", a smaller one inside";
    if (c.copies > 1) text += fmt::format(", {} copies", c.copies);
    if (c.role != CausticsRole::automatic)
        text += fmt::format(", role {}", static_cast<int>(c.role));
    return text + visibility_text(c.visibility);
}

std::string text_of(const Lamp& l) {
    std::string text = fmt::format("{}: {} at {} to {}, extent {:.3g}, power {:.3g}", l.name,
                                   name_of(l.kind, kLamps), text_of(l.position), text_of(l.target),
                                   l.extent, l.power);
    if (l.beam < kPi) text += fmt::format(", beam {:.3g}, blend {:.2g}", l.beam, l.blend);
    if (l.stretch != 1.0f) text += fmt::format(", stretched {:.2g}", l.stretch);
    if (l.soft) text += ", soft falloff";
    if (!l.feeds_caustics) text += ", feeds no caustics";
    return text + visibility_text(l.visibility);
}

// The thing of this name. It exists: parts_of() has named it.
template <class T>
T& named(std::vector<T>& things, const std::string& name) {
    return *std::find_if(things.begin(), things.end(),
                         [&](const T& thing) { return thing.name == name; });
}

// Collects the parts of all things of one kind: each thing as a whole, and each field that is not
// as simple as it may be.
template <class T>
class PartsOf {
public:
    PartsOf(std::vector<Part>& parts, std::vector<T> Plan::*things, const Plan& plan)
        : parts_(parts), things_(things), plan_(plan) {}

    void wholes(size_t least) {
        if ((plan_.*things_).size() <= least) return;
        for (const T& thing : plan_.*things_)
            add(thing.name, [things = things_, name = thing.name](Plan& p) {
                std::erase_if(p.*things, [&](const T& t) { return t.name == name; });
            });
    }
    template <class V>
    void field(const char* what, V T::*member, const V& simple) {
        for (const T& thing : plan_.*things_) {
            if (thing.*member == simple) continue;
            add(thing.name + "." + what, [=, things = things_, name = thing.name](Plan& p) {
                named(p.*things, name).*member = simple;
            });
        }
    }

private:
    void add(std::string name, std::function<void(Plan&)> leave_out) {
        parts_.push_back({std::move(name), std::move(leave_out)});
    }

    std::vector<Part>& parts_;
    std::vector<T> Plan::*things_;
    const Plan& plan_;
};

}  // namespace

bool Plan::is_found_by_rays() const {
    return std::all_of(lamps.begin(), lamps.end(), [](const Lamp& l) {
        return l.extent * std::min(l.stretch, 1.0f) > kFoundByRays;
    });
}

Plan random_plan(uint64_t seed) {
    Dice dice(seed);
    Plan plan;
    for (uint32_t i = 0, n = dice.one_of({1u, 1u, 2u, 2u, 3u}); i < n; ++i)
        plan.casters.push_back(random_caster(dice, i));
    plan.receivers.push_back({.name = "floor"});
    if (dice.chance(0.4)) plan.receivers.push_back({.name = "wall", .wall = true});
    for (Receiver& r : plan.receivers) {
        r.albedo = dice.between(0.3f, 0.9f);
        if (dice.chance(0.4)) r.gloss = dice.between(0.2f, 0.8f);
        if (dice.chance(0.05)) r.visibility = any_visibility(dice);
    }
    for (uint32_t i = 0, n = dice.one_of({0u, 1u, 1u, 1u, 2u, 3u}); i < n; ++i)
        plan.lamps.push_back(random_lamp(dice, i));
    if (plan.lamps.empty() || dice.chance(0.25)) plan.sky = dice.one_of({Sky::even, Sky::peaked});
    plan.orthographic = dice.chance(0.15);
    if (dice.chance(0.15)) plan.aperture = dice.between(0.01f, 0.2f);
    plan.eye = Vec3(dice.between(-1.0f, 1.0f), dice.between(-3.5f, -2.0f), dice.between(1.0f, 3.0f));
    plan.half_view = dice.between(0.15f, 0.6f);
    plan.bounces = dice.one_of({12u, 8u, 4u, 2u});
    plan.diffuse_bounces = dice.one_of({0u, 1u, 1u, 2u, 4u});
    plan.reflective = !dice.chance(0.05);
    plan.refractive = !dice.chance(0.05);
    return plan;
}

std::string Plan::text() const {
    std::string text;
    for (const Caster& c : casters) text += text_of(c) + "\n";
    for (const Receiver& r : receivers)
        text += fmt::format("{}: albedo {:.2g}, gloss {:.2g}{}\n", r.name, r.albedo, r.gloss,
                            visibility_text(r.visibility));
    for (const Lamp& l : lamps) text += text_of(l) + "\n";
    return text + fmt::format(
                      "{}; {} camera at {}, aperture {:.2g}, half view {:.2g}; {} bounces, {} "
                      "of them diffuse; caustics {} {}",
                      name_of(sky, kSkies), orthographic ? "orthographic" : "perspective",
                      text_of(eye), aperture, half_view, bounces, diffuse_bounces,
                      reflective ? "reflective" : "", refractive ? "refractive" : "");
}

std::vector<Part> parts_of(const Plan& plan) {
    std::vector<Part> parts;
    PartsOf casters(parts, &Plan::casters, plan);
    PartsOf receivers(parts, &Plan::receivers, plan);
    PartsOf lamps(parts, &Plan::lamps, plan);
    casters.wholes(0);
    lamps.wholes(plan.sky == Sky::none ? 1 : 0);
    receivers.wholes(1);
    const auto simple = [&](const char* name, auto member, auto value) {
        if (plan.*member != value) parts.push_back({name, [=](Plan& p) { p.*member = value; }});
    };
    if (!plan.lamps.empty()) simple("sky", &Plan::sky, Sky::none);
    simple("lens", &Plan::aperture, 0.0f);
    simple("orthographic", &Plan::orthographic, false);
    simple("limits", &Plan::bounces, 12u);
    simple("indirect", &Plan::diffuse_bounces, 1u);
    simple("no-reflective", &Plan::reflective, true);
    simple("no-refractive", &Plan::refractive, true);
    casters.field("copies", &Caster::copies, 1u);
    casters.field("filling", &Caster::filled, false);
    casters.field("detail", &Caster::detail, Detail::none);
    casters.field("medium", &Caster::absorption, 0.0f);
    casters.field("coat", &Caster::coat, 0.0f);
    casters.field("roughness", &Caster::roughness, 0.0f);
    casters.field("visibility", &Caster::visibility, uint32_t{kVisibleAll});
    casters.field("role", &Caster::role, CausticsRole::automatic);
    casters.field("flip", &Caster::flipped, false);
    casters.field("turn", &Caster::turn, Vec3(0.0f));
    receivers.field("gloss", &Receiver::gloss, 0.0f);
    receivers.field("visibility", &Receiver::visibility, uint32_t{kVisibleAll});
    lamps.field("visibility", &Lamp::visibility, uint32_t{kVisibleAll});
    lamps.field("beam", &Lamp::beam, kPi);
    lamps.field("soft", &Lamp::soft, false);
    lamps.field("stretch", &Lamp::stretch, 1.0f);
    lamps.field("feeds", &Lamp::feeds_caustics, true);
    return parts;
}

void leave_out(Plan& plan, const std::string& part) {
    for (const Part& p : parts_of(plan))
        if (p.name == part) return p.leave_out(plan);
}

}  // namespace spc::fuzz

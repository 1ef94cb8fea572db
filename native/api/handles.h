// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "render/session.h"
#include "scene/builder.h"
#include "scene/caustics_part.h"
#include "shading/uv_needs.h"
#include "specula/specula.h"

// A scene under construction, or frozen: `builder` until commit, `world` after it.
struct spc_scene {
    std::unique_ptr<spc::SceneBuilder> builder = std::make_unique<spc::SceneBuilder>();
    std::optional<spc::RenderScene> world;
    std::string report;
    double commit_seconds = 0.0;
    // What the last answers refer to.
    std::vector<spc::UvNeed> needs{};
    std::vector<spc_uv_need> needed_layers{};
    spc::CausticsPart part{};
    std::string glints{}, no_glints{};
};

struct spc_session {
    spc::Session session;
    std::string report{};
};

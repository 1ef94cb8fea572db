// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "render/session.h"
#include "scene/builder.h"
#include "specula/specula.h"

// A scene under construction, or frozen: `builder` until commit, `world` after it.
struct spc_scene {
    std::unique_ptr<spc::SceneBuilder> builder = std::make_unique<spc::SceneBuilder>();
    std::optional<spc::RenderScene> world;
    std::string report;
    double commit_seconds = 0.0;
};

struct spc_session {
    spc::Session session;
    std::string report{};
};

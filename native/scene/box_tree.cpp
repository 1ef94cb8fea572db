// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/box_tree.h"

#if __has_include(<embree3/rtcore.h>)
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif

#include <stdexcept>

namespace spc {

namespace {

// One for all trees: a device is dear to make. Trees are built by the thread that asks for them.
RTCDevice device() {
    static const RTCDevice shared = rtcNewDevice("threads=1");
    if (shared == nullptr) throw std::runtime_error("Embree could not start");
    return shared;
}

void box_bounds(const RTCBoundsFunctionArguments* args) {
    const auto& boxes = *static_cast<const std::vector<Bounds>*>(args->geometryUserPtr);
    const Bounds& b = boxes[args->primID];
    *args->bounds_o = {b.lower.x, b.lower.y, b.lower.z, 0, b.upper.x, b.upper.y, b.upper.z, 0};
}

struct Query {
    const std::vector<Bounds>& boxes;
    void (*visitor)(uint32_t index, const void* context);
    const void* context;
};

bool holds(const Bounds& b, const Vec3& p) {
    return p.x >= b.lower.x && p.x <= b.upper.x && p.y >= b.lower.y && p.y <= b.upper.y &&
           p.z >= b.lower.z && p.z <= b.upper.z;
}

bool collect(RTCPointQueryFunctionArguments* args) {
    const auto& query = *static_cast<const Query*>(args->userPtr);
    const Vec3 p(args->query->x, args->query->y, args->query->z);
    if (holds(query.boxes[args->primID], p)) query.visitor(args->primID, query.context);
    return false;  // the query stays as large as it is
}

}  // namespace

struct BoxTree::Impl {
    std::vector<Bounds> boxes;
    RTCScene scene = nullptr;
    ~Impl() {
        if (scene != nullptr) rtcReleaseScene(scene);
    }
};

BoxTree::BoxTree(std::vector<Bounds> boxes) : impl_(std::make_unique<Impl>()) {
    impl_->boxes = std::move(boxes);
    if (impl_->boxes.empty()) return;
    RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(impl_->boxes.size()));
    rtcSetGeometryUserData(geometry, &impl_->boxes);
    rtcSetGeometryBoundsFunction(geometry, box_bounds, nullptr);
    rtcCommitGeometry(geometry);
    impl_->scene = rtcNewScene(device());
    rtcAttachGeometry(impl_->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(impl_->scene);
    if (rtcGetDeviceError(device()) == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
}

BoxTree::~BoxTree() = default;

void BoxTree::find(const Vec3& p, Visitor visitor, const void* visitor_context) const {
    if (impl_->scene == nullptr) return;
    RTCPointQuery at{p.x, p.y, p.z, 0.0f, 0.0f};
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    Query query{impl_->boxes, visitor, visitor_context};
    rtcPointQuery(impl_->scene, &at, &context, collect, &query);
}

}  // namespace spc

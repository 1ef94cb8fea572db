// SPDX-License-Identifier: GPL-3.0-or-later
// The driver of all rows.
#include "agreement/matrix.h"

#include <cctype>

namespace spc::test {
namespace {

constexpr size_t kParts = std::tuple_size_v<decltype(Picture::mean)>;

RenderScene scene_of(const Row& row) {
    SceneMaker maker;
    for (const Part& part : {row.camera, row.receiver, row.casters, row.light}) part.add(maker);
    return maker.finish();
}

// What the method's own techniques give of the whole picture: those that splat, else the manifold.
double share_of(const Method& method, const Picture& picture) {
    const bool splats = method.light_paths || method.camera_chains != CameraChainUse::none;
    return (splats ? picture.splats : picture.caustics).mean();
}

double noise_of(const Picture& a, const Picture& b) {
    return std::hypot(a.mean[4].standard_error(), b.mean[4].standard_error());
}

// Of less than some ten hits nothing follows: these may be missed, and then their variance, too.
bool is_known(const MeanEstimate& estimate) {
    constexpr double kFewHits = 0.3;  // relative standard error
    return estimate.standard_error() < kFewHits * estimate.mean();
}

// Whether a picture has the reference's means.
void expect_agreement(const Picture& actual, const Picture& expected, const Row& row,
                      int comparisons, const std::string& what) {
    for (size_t i = 0; i < kParts; ++i) {
        const bool is_whole = i + 1 == kParts;
        if (row.few_hits && !is_whole && !(is_known(actual.mean[i]) && is_known(expected.mean[i])))
            continue;
        EXPECT_TRUE(same_mean(actual.mean[i], expected.mean[i], sidak(kFamily, comparisons)))
            << what << ", part " << i;
    }
}

// Whether the comparison would tell if the method were wrong.
void expect_power(const Picture& actual, const Picture& expected, const Claim& claim,
                  const std::string& what) {
    const double share = share_of(claim.method, actual), noise = noise_of(actual, expected);
    std::cout << what << ": finds " << share / actual.mean[4].mean()
              << " of the picture, an error of that is noticed from " << 5.0 * noise / share
              << std::endl;
    if (claim.notices == 0.0) return;
    EXPECT_GT(share, claim.least_share * actual.mean[4].mean()) << what;
    EXPECT_LT(5.0 * noise, claim.notices * share) << what;
}

void expect_loss(const Picture& actual, const Picture& expected, const Claim& claim,
                 const std::string& what) {
    const double lost = 1.0 - actual.mean[4].mean() / expected.mean[4].mean(),
                 noise = 4.0 * noise_of(actual, expected) / expected.mean[4].mean();
    std::cout << what << ": loses " << lost << " +- " << noise << std::endl;
    EXPECT_GT(lost, (*claim.loses)[0] - noise) << what;
    EXPECT_LT(lost, (*claim.loses)[1] + noise) << what;
}

}  // namespace

std::string Row::name() const {
    std::string name;
    for (const Part& part : {casters, light, receiver, camera}) {
        if (part.name.empty()) continue;
        if (!name.empty()) name += ", ";
        name += part.name;
    }
    return name;
}

int Table::comparisons() const {
    int count = 0;
    for (const Row& row : rows) count += int(row.claims.size() * kParts);
    return count;
}

std::vector<TableRow> rows_of(const Table& table) {
    std::vector<TableRow> rows;
    for (const Row& row : table.rows) rows.push_back({row, table.comparisons()});
    return rows;
}

std::string name_of_test(const testing::TestParamInfo<TableRow>& info) {
    std::string name;
    for (const char c : info.param.row.name()) {
        if (std::isalnum(static_cast<unsigned char>(c)))
            name += c;
        else if (!name.empty() && name.back() != '_')
            name += '_';
    }
    return name;
}

void PrintTo(const TableRow& row, std::ostream* stream) { *stream << row.row.name(); }

TEST_P(AgreementSlow, Holds) {
    constexpr uint32_t kReferenceSeed = 1, kSeed = 1u << 20;
    const auto& [row, comparisons] = GetParam();
    const RenderScene world = scene_of(row);
    const Picture expected = true_picture(row.name(), row.reference.rounds, [&](uint32_t rounds) {
        return render(world, row.settings, row.reference.method, rounds, kReferenceSeed);
    });
    std::optional<Picture> by_light_paths;
    for (const Claim& claim : row.claims) {
        const Method& method = claim.method;
        const Picture actual = render(world, row.settings, method, claim.rounds, kSeed);
        if (claim.loses) {
            expect_loss(actual, expected, claim, method.name);
            continue;
        }
        expect_agreement(actual, expected, row, comparisons, method.name);
        expect_power(actual, expected, claim, method.name);
        // Nor does it show whether the manifold is beside light paths.
        if (by_light_paths && method.light_paths)
            expect_agreement(actual, *by_light_paths, row, comparisons,
                             std::string(method.name) + ", or without the manifold");
        if (method.light_paths && !method.manifold) by_light_paths = actual;
    }
    if (row.blind_path_tracing) {
        constexpr uint32_t kRounds = 10;
        EXPECT_EQ(render(world, row.settings, kPathTracing, kRounds, kSeed).mean[4].mean(), 0.0);
    }
}

}  // namespace spc::test

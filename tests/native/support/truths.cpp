// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/truths.h"

#include "support/power.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>

namespace spc::test {
namespace {

constexpr const char* kHead =
    "# SPDX-License-Identifier: GPL-3.0-or-later\n"
    "# Samples, mean, standard error and name; by `./dev test native --write-truths`.\n";
constexpr const char* kRemedy = "; ./dev test native --write-truths makes it anew";

using Truths = std::vector<std::pair<std::string, Estimates>>;

std::filesystem::path file_of_this_test() {
    const ::testing::TestInfo& test = *::testing::UnitTest::GetInstance()->current_test_info();
    return std::filesystem::path(SPC_TEST_SOURCE_DIR) / "tests/native/truths" /
           fmt::format("{}.{}.txt", test.test_suite_name(), test.name());
}

Truths read(const std::filesystem::path& path) {
    Truths truths;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with('#')) continue;
        std::istringstream words(line);
        size_t count = 0;
        double mean = 0.0, standard_error = 0.0;
        std::string name;
        words >> count >> mean >> standard_error >> std::ws;
        std::getline(words, name);
        if (truths.empty() || truths.back().first != name) truths.push_back({name, {}});
        truths.back().second.push_back(MeanEstimate(count, mean, standard_error));
    }
    return truths;
}

void write(const std::filesystem::path& path, const Truths& truths) {
    std::filesystem::create_directories(path.parent_path());
    std::ofstream file(path);
    file << kHead << std::setprecision(10);
    for (const auto& [name, estimates] : truths)
        for (const MeanEstimate& estimate : estimates)
            file << estimate.count() << ' ' << estimate.mean() << ' ' << estimate.standard_error()
                 << ' ' << name << '\n';
}

// What this test has found so far: the file then has nothing that no test asks for.
void keep(const std::string& name, const Estimates& estimates) {
    static std::map<std::filesystem::path, Truths> kept;
    Truths& truths = kept[file_of_this_test()];
    truths.push_back({name, estimates});
    write(file_of_this_test(), truths);
}

// By the variance of the truth: a few samples may know nothing of theirs. These may be some of the
// truth's own, which makes the difference smaller than is allowed for.
void expect_agreement(const std::string& name, const Estimates& found, const Estimates& kept) {
    constexpr double kFamily = 1e-4;  // probability that a truth fails though nothing has changed
    ASSERT_EQ(found.size(), kept.size()) << "truth of " << name << kRemedy;
    const double significance = sidak(kFamily, static_cast<int>(kept.size()));
    for (size_t i = 0; i < kept.size(); ++i) {
        const double samples = double(kept[i].count()) / double(found[i].count()),
                     deviation = kept[i].standard_error() * std::sqrt(1.0 + samples),
                     difference = std::abs(found[i].mean() - kept[i].mean());
        // A mean without variance is the same but for rounding.
        const double allowed = 1e-5 * std::abs(kept[i].mean());
        EXPECT_TRUE(difference <= allowed ||
                    std::erfc(difference / deviation / std::numbers::sqrt2) > significance)
            << "brute force finds " << found[i].mean() << " for " << name << ", part " << i
            << ", and once found " << kept[i].mean() << " +- " << kept[i].standard_error()
            << "; if that is meant" << kRemedy;
    }
}

Estimates kept_truth(const std::string& name, uint32_t samples) {
    for (const auto& [kept_name, estimates] : read(file_of_this_test()))
        if (kept_name == name && estimates[0].count() == samples) return estimates;
    ADD_FAILURE() << "no truth of " << name << " from " << samples << " samples in "
                  << file_of_this_test() << kRemedy;
    return {};
}

}  // namespace

bool writes_truths() { return std::getenv("SPECULA_TEST_WRITE_TRUTHS") != nullptr; }

Estimates truth(const std::string& name, uint32_t samples,
                const std::function<Estimates(uint32_t samples)>& by_brute_force) {
    constexpr uint32_t kShare = 20;  // is enough to notice what becomes of path tracing itself
    if (writes_truths()) {
        const Estimates found = by_brute_force(samples);
        keep(name, found);
        return found;
    }
    const Estimates kept = kept_truth(name, samples),
                    found = by_brute_force(nightly() ? samples : std::max(samples / kShare, 1u));
    if (kept.empty()) return found;
    expect_agreement(name, found, kept);
    return nightly() ? found : kept;
}

}  // namespace spc::test

// SPDX-License-Identifier: GPL-3.0-or-later
// One matrix of casters, lights, receivers and cameras: in each of its rows every method has to
// make the picture that brute force makes. Other files of this folder hold the rows, a table each.
#pragma once

#include "integrator/pictures.h"

namespace spc::test {

// A column of a row. What the scene's usual one is has no name.
struct Part {
    std::string name;
    std::function<void(SceneMaker&)> add;
};

// That a method makes the right picture, and how well that is known.
struct Claim {
    Method method;
    uint32_t rounds;  // samples of each pixel
    // A relative error of what the method itself finds, beside path tracing, that the comparison
    // must notice; 0: another claim of the row says it of the same technique.
    double notices = 0.0;
    double least_share = 0.02;  // of the picture, that it must find itself then
    // What a method that loses light loses of all: at least, and at most.
    std::optional<std::array<double, 2>> loses = {};
};

// What finds the picture that the others have to agree with.
struct Reference {
    uint32_t rounds;
    Method method = kPathTracing;
};

struct Row {
    Part casters;
    Part light = {"", [](SceneMaker& maker) { add_bulb(maker); }};
    Part receiver = {"", [](SceneMaker& maker) { add_floor(maker); }};
    Part camera = {"", [](SceneMaker& maker) { set_camera(maker); }};
    Reference reference = {24000};
    std::vector<Claim> claims = {};
    IntegratorSettings settings = few_bounces();
    // Path tracing finds no light at all: lamps without size, or next to none.
    bool blind_path_tracing = false;
    // Some parts of the picture may be a few bright hits, and are left out of the comparison.
    bool few_hits = false;

    std::string name() const;
};

// The rows of a table, which share the probability that a right one fails.
struct Table {
    std::vector<Row> rows;
    int comparisons() const;
};

struct TableRow {
    Row row;
    int comparisons;  // of its table
};
std::vector<TableRow> rows_of(const Table& table);

class AgreementSlow : public testing::TestWithParam<TableRow> {};

// Each row is a test, `Table/AgreementSlow.Holds/name_of_the_row`.
#define SPC_AGREEMENT(table, make_table)                                                     \
    INSTANTIATE_TEST_SUITE_P(table, AgreementSlow, testing::ValuesIn(rows_of(make_table())), \
                             name_of_test)
std::string name_of_test(const testing::TestParamInfo<TableRow>& info);
void PrintTo(const TableRow& row, std::ostream* stream);  // its name, for GoogleTest

}  // namespace spc::test

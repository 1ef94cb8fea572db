// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernels.h"

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    spc::bench::add_walks();
    spc::bench::add_surfaces();
    spc::bench::add_closures();
    spc::bench::add_rays();
    spc::bench::add_glints();
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}

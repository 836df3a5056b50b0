// The opening of the line-stretch demo on coarser and finer meshes, whole and by one sector.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/bench/work/opening.hpp"

namespace twinchute::bench {
namespace {

Scene with_mesh(Scene scene, double factor) {
    MeshCounts& mesh = scene.full.mesh;
    for (int* count : {&mesh.gore_columns, &mesh.gore_rows, &mesh.line_elements, &mesh.riser_elements})
        *count = std::max(1, static_cast<int>(std::lround(factor * *count)));
    return scene;
}

Scene with_columns(Scene scene, int columns) {
    scene.full.mesh.gore_columns = columns;
    return scene;
}

void add(Curve& curve, const std::string& setting, const Scene& scene, const Opening& truth) {
    curve.samples.push_back(sample_of(setting, run_opening(scene), truth));
    say(curve);
}

}  // namespace

void study_opening_by_mesh(const Scene& demo, const MeshSettings& with,
                           const std::filesystem::path& directory) {
    Scene sector = demo;
    sector.full.symmetry = Symmetry::sector;
    const Scene finest = with_mesh(sector, with.reference);
    const Measured reference = run_opening(finest);
    say("finest mesh", reference);
    Study study = opening_study(
        with.name, "Opening of the demo: error against the mesh",
        fmt::format("runs of 4 s; against {:g} times the elements each way ({} across a gore, {} rows)",
                    with.reference, finest.full.mesh.gore_columns, finest.full.mesh.gore_rows),
        micrometre, micrometre_apart(demo), run_opening(demo).opening);
    Curve whole{"all gores, all directions", "all gores", {}},
        across{"all gores, across alone", "all gores", {}},
        one{"one sector, all directions", "one sector", {}},
        one_across{"one sector, across alone", "one sector", {}};
    for (const double factor : with.whole)
        add(whole, fmt::format("x{:g}", factor), with_mesh(demo, factor), reference.opening);
    for (const double factor : with.sector)
        add(one, fmt::format("x{:g}", factor), with_mesh(sector, factor), reference.opening);
    for (const int columns : with.columns) {
        add(across, fmt::format("{} across", columns), with_columns(demo, columns), reference.opening);
        add(one_across, fmt::format("{} across", columns), with_columns(sector, columns), reference.opening);
    }
    study.curves = {std::move(whole), std::move(across), std::move(one), std::move(one_across)};
    write(study, directory);
}

}  // namespace twinchute::bench

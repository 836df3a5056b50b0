#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <fmt/format.h>

#include "fullsim/elements/cable.hpp"
#include "fullsim/elements/fabric_spring.hpp"
#include "fullsim/elements/membrane.hpp"
#include "fullsim/run/fields.hpp"
#include "fullsim/simulation.hpp"
#include "fullsim/storage/gore_batched/kernels.hpp"
#include "fullsim/storage/unstructured/kernels.hpp"
#include "lib/scene/read_scene.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/counted.hpp"

namespace twinchute::bench {
namespace {

namespace law = fullsim::HWY_NAMESPACE;

using fullsim::ForceModel;
using fullsim::Simulation;
using fullsim::State;

/// A mesh of the C-9, elements of one shape on all, and how far it flies before anything is measured. The
/// coarse ones fly from line stretch until they fill. Fine ones would take minutes to get there: they start
/// open, and are measured before the fabric has let go of the stress that it starts with.
struct Size {
    const char* triangles;  // about
    int columns, rows, line_elements;
    const char* start;
    int steps;
};

constexpr const char* drawn_out = "line-stretch";
constexpr const char* open = "inflated";
constexpr Size sizes[] = {
    {"500", 1, 9, 16, drawn_out, 20000},
    {"2000", 2, 17, 31, drawn_out, 40000},
    {"8000", 4, 34, 62, open, 20},
    {"120000", 16, 136, 248, open, 20},
};

constexpr int packed_steps = 2000;  // of a pack: lines and fabric begin to be drawn out

/// Bytes that the program has allocated; 0 where the C library cannot tell.
double allocated() {
#ifdef __GLIBC__
    const auto info = ::mallinfo2();
    return static_cast<double>(info.uordblks + info.hblkhd);
#else
    return 0.0;
#endif
}

/// A parachute some way into its flight: elements taut, wrinkled and slack, nodes that move.
class InFlight {
public:
    InFlight(const Size& size, bool packed)
        : scene_(read_scene(path_of(packed ? crane_drop : c9_inflation), keys(size, packed))) {
        const double before = allocated();
        simulation_ = std::make_unique<Simulation>(scene_);
        bytes_ = allocated() - before;
        step(packed ? packed_steps : size.steps);
        simulation_->evaluate_forces();
    }

    const Scene& scene() const { return scene_; }
    Simulation& simulation() { return *simulation_; }
    /// [B] of the whole simulation.
    double bytes() const { return bytes_; }
    /// [B] of one in the unstructured layout, after a step.
    double bytes_if_indexed() const {
        const double before = allocated();
        Simulation simulation(scene_, [](const Scene& scene, const fullsim::Mesh& mesh,
                                         const fullsim::NodeConstants& constants) {
            return make_unstructured_layout(scene, mesh, constants);
        });
        simulation.evaluate_forces();
        simulation.step_to(1e9);
        return allocated() - before;
    }

    /// Whole steps as a run takes them; leaves the forces to be evaluated.
    void step(int count) {
        using fullsim::Stage;
        Simulation& s = *simulation_;
        const fullsim::SystemState& now = s.system();
        for (int n = 0; n < count; ++n) {
            s.evaluate_forces();
            if (now.stage != Stage::deployment && now.time >= s.inflation().end_of(now.phase))
                s.begin(now.phase == Phase::initial ? Phase::filling : Phase::open);
            s.step_to(now.stage == Stage::deployment ? 1e9 : s.inflation().end_of(now.phase));
        }
    }

    /// [%] of the fabric triangles that are slack, wrinkled, taut in a state of this mesh.
    std::array<double, 3> fabric_states(const State& state) const {
        const fullsim::Mesh& mesh = simulation_->mesh();
        const VtuGrid grid = fullsim::field_frame(fullsim::mesh_grid(mesh), mesh, state);
        const auto array = std::ranges::find(grid.cell_data, "wrinkling_state", &VtuArray::name);
        std::array<double, 3> share{};
        const double each = 100.0 / static_cast<double>(mesh.triangles.size());
        for (const std::int8_t kind : std::get<std::vector<std::int8_t>>(array->values))
            if (kind >= 0) share[kind] += each;
        return share;
    }

private:
    static std::vector<std::string> keys(const Size& size, bool packed) {
        const auto key = [](const char* name, int value) {
            return std::string("full.mesh.") + name + "=" + std::to_string(value);
        };
        std::vector<std::string> all{key("gore_columns", size.columns), key("gore_rows", size.rows),
                                     key("line_elements", size.line_elements),
                                     // Symmetric gores would all be in one state.
                                     "full.noise={ amplitude = '1 mm', seed = 1 }"};
        if (!packed) all.push_back(std::string("parachute.deploy.by='") + size.start + "'");
        return all;
    }

    Scene scene_;
    std::unique_ptr<Simulation> simulation_;
    double bytes_ = 0.0;
};

/// Shared by benchmarks that follow each other, so that never two large ones exist at once.
InFlight& in_flight(const Size& size, bool packed = false) {
    static std::unique_ptr<InFlight> held;
    static std::pair<const char*, bool> what;
    if (!held || what != std::pair{size.triangles, packed}) {
        held.reset();
        held = std::make_unique<InFlight>(size, packed);
        what = {size.triangles, packed};
    }
    return *held;
}

void count_elements(benchmark::State& bench, double elements) {
    using benchmark::Counter;
    bench.counters["elements"] = elements;
    bench.counters["element_steps_per_s"] = Counter(elements, Counter::kIsIterationInvariantRate);
    bench.counters["ns_per_element"] =
        Counter(1e-9 * elements, Counter::kIsIterationInvariantRate | Counter::kInvert);
}

void count_fabric(benchmark::State& bench, const std::array<double, 3>& share) {
    bench.counters["slack_percent"] = share[0];
    bench.counters["wrinkled_percent"] = share[1];
    bench.counters["taut_percent"] = share[2];
}

void measure_block(benchmark::State& bench, const Size& size, bool packed, const fullsim::ForceBlock& row) {
    InFlight& flight = in_flight(size, packed);
    const fullsim::Mesh& mesh = flight.simulation().mesh();
    State state = flight.simulation().synchronised_state();
    clear_forces(state);  // of all nodes: its layout may hold those of some
    if (row.name == "membrane") count_fabric(bench, flight.fabric_states(state));
    const std::unique_ptr<const ForceModel> block = row.make(flight.scene(), mesh);
    for (auto _ : bench)
        block->add_forces(state);
    // Loads on nodes have no elements: nodes of the canopy there.
    const std::size_t elements = block->elements() > 0 ? block->elements() : mesh.canopy_nodes;
    count_elements(bench, static_cast<double>(elements));
}

void measure_advance(benchmark::State& bench, const Size& size) {
    InFlight& flight = in_flight(size);
    State state = flight.simulation().synchronised_state();
    clear_forces(state);  // as above
    for (auto _ : bench)
        fullsim::advance(state, flight.simulation().constants(), 1e-7, state.added_mass);
    count_elements(bench, flight.simulation().mesh().node_count());
}

/// Cost of a loop for each of its elements.
struct Work {
    Tally of_element;
    double node_words;  ///< doubles of nodes for each element: each has to come and go at least once
};

bool is_line(const fullsim::Cable& cable) {
    return cable.kind == fullsim::CableKind::line;
}
double lines_of(const fullsim::Mesh& mesh) {
    return static_cast<double>(std::ranges::count_if(mesh.cables, is_line));
}
/// Nodes of the canopy for each of `elements` of its elements.
double canopy_nodes_for(const fullsim::Mesh& mesh, double elements) {
    return static_cast<double>(mesh.canopy_nodes) / elements;
}

/// Edges of fabric with a hole: as many as triangles and nodes together (Euler).
double edges_of(const fullsim::Mesh& mesh) {
    return static_cast<double>(mesh.triangles.size()) + static_cast<double>(mesh.canopy_nodes);
}

Work membrane_work(const fullsim::Mesh& mesh) {
    const Tally tally = tally_of<CountedTriangle>(
        [](const auto& view) { law::membrane_forces<true, fullsim::AirOnFabric::pushes>(view, {}); });
    // Position and velocity; force and push, read and written.
    return {tally, (6.0 + 6.0 + 6.0) * canopy_nodes_for(mesh, static_cast<double>(mesh.triangles.size()))};
}
Work cable_work(const fullsim::Mesh& mesh) {
    const double cables = static_cast<double>(mesh.cables.size()), lines = lines_of(mesh) / cables;
    const auto loop = [](const auto& view) { law::cable_forces(view); };
    const Tally tally = tally_of<CountedLine>(loop) * lines + tally_of<CountedSpan>(loop) * (1.0 - lines);
    // A line has as many nodes as elements; its forces are set, those of tapes are added to.
    return {tally, (6.0 + 3.0) * lines + (6.0 + 6.0) * std::min(1.0 - lines, canopy_nodes_for(mesh, cables))};
}
Work line_drag_work(const fullsim::Mesh&) {
    const CylinderDragTable table;
    const fullsim::LineAir air{&table, 1.0, 1.0, 1.0};
    const Tally tally =
        tally_of<CountedLine>([&](const auto& view) { law::cable_forces_in<false>(view, air); });
    return {tally, 6.0 + 3.0};
}
Work spring_work(const fullsim::Mesh& mesh) {
    const Tally tally =
        tally_of<CountedSpan>([](const auto& view) { law::spring_forces_of<true, true>(view, {}); });
    return {tally, (6.0 + 6.0) * canopy_nodes_for(mesh, edges_of(mesh))};
}
Work fabric_drag_work(const fullsim::Mesh& mesh) {
    const Tally tally =
        tally_of<CountedTriangle>([](const auto& view) { law::fabric_drag_forces(view, {}); });
    return {tally, (6.0 + 6.0) * canopy_nodes_for(mesh, static_cast<double>(mesh.triangles.size()))};
}

/// Some of a flight's blocks, or its whole step without what watches it, in one of the layouts.
struct LayoutPart {
    const char* name;
    std::vector<std::string_view> blocks;  // none: all, and the node update
    enum class Per { triangle, cable, line, element, edge } per;
    Work (*work)(const fullsim::Mesh&);
    bool packed = false;  ///< of fabric that leaves its pack
};

const std::vector<LayoutPart> layout_parts{
    {"membrane and pressure", {"membrane", "canopy pressure"}, LayoutPart::Per::triangle, &membrane_work},
    {"cable", {"tapes", "lines"}, LayoutPart::Per::cable, &cable_work},
    {"line drag", {"line drag"}, LayoutPart::Per::line, &line_drag_work},
    {"bare step", {}, LayoutPart::Per::element, nullptr},
    {"springs and folds",
     {"fabric springs", "deployment resistance"},
     LayoutPart::Per::edge,
     &spring_work,
     true},
    {"drag of fabric", {"fabric drag"}, LayoutPart::Per::triangle, &fabric_drag_work, true},
};

struct LayoutChoice {
    std::string name;
    Simulation::LayoutMaker make;
};

/// The force blocks themselves, and each layout with each instruction set of this machine.
std::vector<LayoutChoice> layout_choices() {
    using namespace fullsim;
    std::vector<LayoutChoice> all{{"reference", [](const Scene&, const Mesh& mesh, const NodeConstants& c) {
                                       return make_reference_layout(mesh, c);
                                   }}};
    for (const unstructured::Kernels& kernels : unstructured::all_kernels())
        all.push_back({fmt::format("unstructured {}", kernels.instruction_set),
                       [&kernels](const Scene& scene, const Mesh& mesh, const NodeConstants& c) {
                           return make_unstructured_layout(scene, mesh, c, &kernels);
                       }});
    for (const GoreKernels& kernels : all_gore_kernels())
        all.push_back({fmt::format("gores {}", kernels.instruction_set),
                       [&kernels](const Scene& scene, const Mesh& mesh, const NodeConstants& c) {
                           return make_gore_layout(scene, mesh, c, &kernels);
                       }});
    return all;
}

double count_of(const fullsim::Mesh& mesh, LayoutPart::Per per) {
    switch (per) {
        case LayoutPart::Per::triangle:
            return static_cast<double>(mesh.triangles.size());
        case LayoutPart::Per::cable:
            return static_cast<double>(mesh.cables.size());
        case LayoutPart::Per::line:
            return lines_of(mesh);
        case LayoutPart::Per::edge:
            return edges_of(mesh);
        case LayoutPart::Per::element:
            break;
    }
    return static_cast<double>(mesh.triangles.size() + mesh.cables.size());
}

void measure_layout(benchmark::State& bench, const Size& size, const LayoutPart& part,
                    const LayoutChoice& choice) {
    InFlight& flight = in_flight(size, part.packed);
    Simulation& simulation = flight.simulation();
    State state = simulation.synchronised_state();
    auto structure = make_structure(flight.scene(), simulation.mesh(), state.stage);
    auto loads = make_loads(flight.scene(), simulation.mesh(), state.stage);
    const auto left_out = [&](const auto& model) {
        return !part.blocks.empty() && std::ranges::find(part.blocks, model->name()) == part.blocks.end();
    };
    std::erase_if(structure, left_out);
    std::erase_if(loads, left_out);
    const auto layout = choice.make(flight.scene(), simulation.mesh(), simulation.constants());
    fullsim::BlockClock clock;
    clock.begin(std::vector<std::string>(structure.size() + loads.size(), "block"));
    layout->begin(state, structure, loads);
    for (auto _ : bench) {
        clock.begin_step(false);
        layout->evaluate(state, clock);
        if (part.blocks.empty()) layout->advance(state, 1e-7, 1, state.added_mass);
    }
    count_elements(bench, count_of(simulation.mesh(), part.per));
    if (part.work) {
        const Work work = part.work(simulation.mesh());
        bench.counters["operations"] = work.of_element.operations;
        bench.counters["B_of_accesses"] = sizeof(double) * work.of_element.words;
        bench.counters["B_of_nodes"] = sizeof(double) * work.node_words;
    }
}

/// With the new bound on the step that comes every so many steps.
void measure_step(benchmark::State& bench, const Size& size) {
    constexpr int steps = 20;
    InFlight& flight = in_flight(size);
    const fullsim::Mesh& mesh = flight.simulation().mesh();
    count_fabric(bench, flight.fabric_states(flight.simulation().synchronised_state()));
    const std::int64_t before = flight.simulation().element_steps();
    for (auto _ : bench)
        flight.step(steps);
    using benchmark::Counter;
    // Triangles and cables, lines once more for every subcycle: what a record calls element-steps.
    const auto evaluated = static_cast<double>(flight.simulation().element_steps() - before);
    count_elements(bench, evaluated / static_cast<double>(bench.iterations()));
    bench.counters["elements"] = static_cast<double>(mesh.triangles.size() + mesh.cables.size());
    bench.counters["us_per_step"] =
        Counter(1e-6 * steps, Counter::kIsIterationInvariantRate | Counter::kInvert);
    bench.counters["triangles"] = static_cast<double>(mesh.triangles.size());
    bench.counters["B_per_triangle"] = flight.bytes() / static_cast<double>(mesh.triangles.size());
    bench.counters["B_per_triangle_indexed"] =
        flight.bytes_if_indexed() / static_cast<double>(mesh.triangles.size());
}

/// "canopy pressure" on 2000 triangles: "element/canopy-pressure/2000".
std::string name_of(std::string_view block, const Size& size) {
    std::string name = "element/" + std::string(block) + "/" + size.triangles;
    std::ranges::replace(name, ' ', '-');
    return name;
}

}  // namespace

void register_elements() {
    using fullsim::Stage;
    const Scene filling = read_scene(path_of(c9_inflation)), packed = read_scene(path_of(crane_drop));
    for (const Size& size : sizes) {
        for (const fullsim::ForceBlock& row : fullsim::force_blocks())
            if (row.needed(filling, Stage::flight))
                benchmark::RegisterBenchmark(name_of(row.name, size).c_str(), &measure_block, size, false,
                                             row);
        benchmark::RegisterBenchmark(name_of("node update", size).c_str(), &measure_advance, size);
        const auto register_parts = [&size](bool of_pack) {
            for (const LayoutPart& part : layout_parts)
                for (const LayoutChoice& choice : layout_choices())
                    if (part.packed == of_pack)
                        benchmark::RegisterBenchmark(
                            name_of(fmt::format("{}, {}", part.name, choice.name), size).c_str(),
                            &measure_layout, size, part, choice);
        };
        register_parts(false);
        benchmark::RegisterBenchmark(name_of("step", size).c_str(), &measure_step, size);
        // Blocks that act before snatch only, in their own state.
        for (const fullsim::ForceBlock& row : fullsim::force_blocks())
            if (row.needed(packed, Stage::deployment) && !row.needed(filling, Stage::flight))
                benchmark::RegisterBenchmark(name_of(row.name, size).c_str(), &measure_block, size, true,
                                             row);
        register_parts(true);
    }
}

}  // namespace twinchute::bench

// Steps take no memory from the heap: every request of this program is counted, and a hundred steps in any
// layout make none. Expected: zero, what an inner loop may ask for.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "fullsim/simulation.hpp"
#include "tests/support/c9_scene.hpp"

namespace {

std::atomic<long> requests{0};

void* request(std::size_t size, std::size_t alignment) {
    requests.fetch_add(1, std::memory_order_relaxed);
    const std::size_t whole = (size + alignment - 1) / alignment * alignment;
    void* const memory = std::aligned_alloc(alignment, whole > 0 ? whole : alignment);
    if (memory == nullptr) throw std::bad_alloc();
    return memory;
}

}  // namespace

// These four are what all other forms of new and delete come down to.
void* operator new(std::size_t size) {
    return request(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return request(size, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}

namespace twinchute::fullsim {
namespace {

/// Heap requests of a hundred steps, bounds on the step among them, after some that may fill what grows once.
long requests_of_steps(Simulation& simulation) {
    const auto take = [&](int steps) {
        for (int k = 0; k < steps; ++k) {
            simulation.evaluate_forces();
            simulation.step_to(1e9);
        }
    };
    take(60);
    const long before = requests.load();
    take(100);
    return requests.load() - before;
}

Scene drawn_out() {
    Scene scene = test::c9_scene();
    scene.full.mesh = {2, 7, 10, 2};
    scene.full.line_substeps = 4;
    scene.payload.drag_area = 0.4;
    scene.full.alpha = 2.0;
    scene.aerodynamics.added_mass->momentum = AddedMassMomentum::accreting;
    return scene;
}

Scene open() {
    Scene scene = drawn_out();
    scene.parachutes.front().deploy.by = DeployBy::inflated;
    return scene;
}

Scene packed() {
    Scene scene = test::packed_c9(DeployBy::static_line);
    scene.full.line_substeps = 4;
    return scene;
}

struct NamedLayout {
    const char* name;
    Simulation::LayoutMaker make;
};

const NamedLayout gores{"gore-batched", [](const Scene& s, const Mesh& m, const NodeConstants& c) {
                            return make_gore_layout(s, m, c);
                        }};
const NamedLayout any_mesh{"unstructured", [](const Scene& s, const Mesh& m, const NodeConstants& c) {
                               return make_unstructured_layout(s, m, c);
                           }};
const NamedLayout one_sector{"sector", [](const Scene& s, const Mesh& m, const NodeConstants& c) {
                                 return make_sector_layout(s, m, c);
                             }};

TEST(Allocation, IsCounted) {
    const long before = requests.load();
    const std::vector<double> memory(3, 1.0);
    EXPECT_EQ(memory.back(), 1.0);
    EXPECT_GT(requests.load(), before);
}

TEST(Allocation, StepsAskForNone) {
    for (const Scene& scene : {drawn_out(), open()})
        for (const NamedLayout* layout : {&gores, &any_mesh}) {
            Simulation simulation(scene, layout->make);
            EXPECT_EQ(requests_of_steps(simulation), 0) << layout->name;
        }
}

TEST(Allocation, StepsOfASectorAskForNone) {
    for (Scene scene : {drawn_out(), open()}) {
        scene.full.symmetry = Symmetry::sector;
        Simulation simulation(scene, one_sector.make);
        EXPECT_EQ(requests_of_steps(simulation), 0);
    }
}

TEST(Allocation, StepsFromThePackAskForNone) {
    for (const NamedLayout* layout : {&gores, &any_mesh}) {
        const Scene scene = packed();
        Simulation simulation(scene, layout->make);
        EXPECT_EQ(requests_of_steps(simulation), 0) << layout->name;
    }
}

}  // namespace
}  // namespace twinchute::fullsim

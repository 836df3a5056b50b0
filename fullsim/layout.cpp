#include "fullsim/layout.hpp"

#include <algorithm>
#include <utility>

#include "fullsim/step/stable_step.hpp"

namespace twinchute::fullsim {
namespace {

class IndexedLayout final : public Layout {
public:
    IndexedLayout(const Mesh& mesh, const NodeConstants& constants) : mesh_(mesh), constants_(constants) {}

    std::string_view name() const override { return "indexed"; }
    std::string_view instruction_set() const override { return lane_instruction_set(); }

    void begin(State& state, const ForceModels& structure, const ForceModels& loads) override {
        structure_ = &structure;
        loads_ = &loads;
        clear_forces(state);
    }
    void store(State&) const override {}

    double membrane_energy(State& state) const override {
        const auto membrane = std::ranges::find(*structure_, "membrane", &ForceModel::name);
        const double weight = std::exchange(state.fe_weight, 1.0);
        const double energy = (*membrane)->energy(state);
        state.fe_weight = weight;
        return energy;
    }

    void evaluate(State& state, BlockClock& clock) override {
        const auto add = [&](const ForceModels& models) {
            for (const auto& model : models)
                clock.run([&] { model->add_forces(state); });
        };
        add(*structure_);
        state.riser_force = to_vec3(state.force[mesh_.payload()].value);
        add(*loads_);
    }
    double stable_step(const State& state) override {
        return fullsim::stable_step(state, constants_, *structure_, *loads_).dt;
    }
    void advance(State& state, double dt, double next_added_mass) override {
        fullsim::advance(state, constants_, dt, next_added_mass);
    }

private:
    const Mesh& mesh_;
    const NodeConstants& constants_;
    const ForceModels* structure_ = nullptr;
    const ForceModels* loads_ = nullptr;
};

}  // namespace

void BlockClock::begin(const std::vector<std::string>& names) {
    active_.clear();
    for (const std::string& name : names) {
        const auto known = std::ranges::find(accounts_, name, &Account::name);
        active_.push_back(static_cast<std::size_t>(known - accounts_.begin()));
        if (known == accounts_.end()) accounts_.push_back({name});
    }
}

std::vector<BlockCost> BlockClock::costs() const {
    std::vector<BlockCost> costs;
    for (const Account& a : accounts_)
        if (a.sampled > 0)
            costs.push_back(
                {a.name, a.seconds * static_cast<double>(a.steps) / static_cast<double>(a.sampled)});
    return costs;
}

std::unique_ptr<Layout> make_layout(const Scene& scene, const Mesh& mesh, const NodeConstants& constants) {
    auto gores = make_gore_layout(scene, mesh, constants);
    return gores ? std::move(gores) : make_indexed_layout(mesh, constants);
}

std::unique_ptr<Layout> make_indexed_layout(const Mesh& mesh, const NodeConstants& constants) {
    return std::make_unique<IndexedLayout>(mesh, constants);
}

}  // namespace twinchute::fullsim

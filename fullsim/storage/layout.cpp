#include "fullsim/storage/layout.hpp"

#include <algorithm>
#include <utility>

#include "fullsim/forces/registry.hpp"
#include "fullsim/time/critical_step.hpp"
#include "fullsim/time/energy.hpp"
#include "fullsim/time/subcycling.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::fullsim {
namespace {

class ReferenceLayout final : public Layout {
public:
    ReferenceLayout(const Mesh& mesh, const NodeConstants& constants) : mesh_(mesh), constants_(constants) {}

    std::string_view name() const override { return "reference"; }
    std::string_view instruction_set() const override { return lane_instruction_set(); }

    void begin(State& state, const ForceModels& structure, const ForceModels& loads,
               const Body* body) override {
        body_ = body;
        structure_ = &structure;
        loads_ = &loads;
        lines_ = nullptr;
        for (const auto& model : structure)
            if (force_block(model->block()).subcycles) lines_ = model.get();
        std::vector<NodeIndex> nodes;
        if (lines_) {
            GershgorinSums pulled = no_rows(state);
            lines_->add_row_sums(state, pulled);
            for (NodeIndex i = 0; i < mesh_.node_count(); ++i)
                if (pulled.stiffness[i] > 0.0 || (body && i == mesh_.payload())) nodes.push_back(i);
        }
        pulled_ = SubcycledNodes(std::move(nodes), mesh_.first_attachment(), mesh_.attachments.size());
        weights_.begin(state, constants_, structure, lines_);
        line_damping_ = 0.0;
        clear_forces(state);
    }
    void store(State&) const override {}

    double membrane_energy(State& state) const override {
        const ForceModel* membrane = find_block(*structure_, Block::membrane);
        const double weight = std::exchange(state.fe_weight, 1.0);
        const double energy = membrane->energy(state);
        state.fe_weight = weight;
        return energy;
    }

    EnergiesAndStrains levels(const State& state) const override {
        return levels_of(state, constants_, *structure_);
    }
    double fabric_strain(const State& state) const override { return fabric_strain_of(state, *structure_); }

    void evaluate(State& state, BlockClock& clock) override {
        const auto add = [&](const ForceModels& models) {
            for (const auto& model : models)
                clock.run([&] {
                    if (model.get() == lines_)
                        pulled_.note(state, [&] { line_damping_ = pull_lines(state); });
                    else
                        model->add_forces(state);
                });
        };
        add(*structure_);
        note_riser_force(state, mesh_.payload());
        add(*loads_);
    }
    CriticalSteps critical_steps(const State& state) override {
        weights_.renew(state);
        return fullsim::critical_steps(state, constants_, *structure_, *loads_, lines_, weights_.by_node());
    }
    void accelerate(const Vec3& acceleration) override { acceleration_ += acceleration; }
    void impulse(State& state) override {
        for (NodeIndex i = 0; i < mesh_.canopy_nodes; ++i)
            state.force[i].value += constants_.mass[i] * to_lanes(acceleration_);
        acceleration_ = Vec3::Zero();
        if (!together()) return give_impulse(state, constants_, dt_, subcycles_, pulled_, body_, step_sums_);
        state.damping_power += line_damping_;
        const double kick = 0.5 * (dt_ + state.dt);
        move_all(state, constants_, dt_, step_sums_);
        if (body_) body_->advance(state, kick, dt_);
    }
    void pull(State& state, int) override {
        line_damping_ = pull_lines(state);
        state.in_subcycles.add(state.force[mesh_.payload()].value);
    }
    void drift(State& state, int k) override {
        drift_in_subcycle(state, constants_, subcycle(state, dt_, subcycles_, k), pulled_, line_damping_,
                          body_, step_sums_);
    }
    void end_step(State& state, double next_added_mass) override {
        const double kick = 0.5 * (dt_ + state.dt);
        if (!together())
            end_subcycles(state, constants_, dt_, subcycles_, pulled_, line_damping_, body_, step_sums_);
        finish_step(state, constants_, step_sums_, kick, dt_, dt_ / subcycles_, next_added_mass);
    }
    void serialize(Archive& archive, const State&) override { weights_.serialize(archive); }

private:
    void separate(State& state) override { pulled_.take_others(state); }
    /// [W] dissipated.
    double pull_lines(State& state) const {
        const double others = std::exchange(state.damping_power, 0.0);
        lines_->add_forces(state);
        if (body_) body_->pull(state);
        return std::exchange(state.damping_power, others);
    }

    const Mesh& mesh_;
    const NodeConstants& constants_;
    const ForceModels* structure_ = nullptr;
    const ForceModels* loads_ = nullptr;
    const ForceModel* lines_ = nullptr;
    SubcycledNodes pulled_;
    PerronScaling weights_;
    double line_damping_ = 0.0;         // [W]
    Vec3 acceleration_ = Vec3::Zero();  // [m/s^2] of the canopy in this step, by others
};

}  // namespace

void Layout::read(const State& state, std::span<const NodeIndex> nodes, std::span<NodeRecord> to) const {
    std::ranges::transform(nodes, to.begin(), [&](NodeIndex i) { return state.node[i]; });
}

void Layout::push(State& state, std::span<const NodeIndex> nodes, std::span<const Lanes> force) const {
    for (std::size_t k = 0; k < nodes.size(); ++k)
        state.force[nodes[k]].value += force[k];
}

EnergiesAndStrains levels_of(const State& state, const NodeConstants& constants,
                             const ForceModels& structure) {
    EnergiesAndStrains levels{kinetic_energy(state, constants), elastic_energy(state, structure), {}};
    for (const auto& model : structure)
        levels.strain.push_back(model->extreme(state).strain);
    return levels;
}

double fabric_strain_of(const State& state, const ForceModels& structure) {
    double longest = -1.0;
    for (const auto& model : structure)
        if (is_folding_fabric(model->block())) longest = std::max(longest, model->extreme(state).strain);
    return longest;
}

void BlockClock::begin(const std::vector<std::string>& names) {
    active_.clear();
    for (const std::string& name : names) {
        const auto known = std::ranges::find(accounts_, name, &Account::name);
        active_.push_back(static_cast<std::size_t>(known - accounts_.begin()));
        if (known == accounts_.end()) accounts_.push_back({name});
    }
}

void BlockClock::add(const BlockClock& other) {
    for (Account& account : accounts_) {
        const auto same = std::ranges::find(other.accounts_, account.name, &Account::name);
        if (same == other.accounts_.end()) continue;
        account.seconds += same->seconds;
        account.sampled += same->sampled;
        account.steps += same->steps;
    }
}

void BlockClock::serialize(Archive& archive) {
    archive.length("accounts", accounts_, 1000);
    for (Account& account : accounts_) {
        auto& [name, seconds, sampled, steps] = account;
        archive.text("block", name);
        archive.number("seconds", seconds);
        archive.whole("sampled", sampled, 0);
        archive.whole("steps", steps, 0);
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

ElementCount Layout::elements(const ForceModels& structure) const {
    ElementCount count;
    for (const auto& model : structure) {
        count.all += model->elements();
        if (force_block(model->block()).subcycles) count.in_subcycles += model->elements();
    }
    return count;
}

std::unique_ptr<Layout> make_layout(const Scene& scene, const Mesh& mesh, const NodeConstants& constants,
                                    int threads) {
    if (scene.full.symmetry == Symmetry::sector) {
        std::string why;
        auto sector = make_sector_layout(scene, mesh, constants, &why);
        if (!sector)
            throw SceneError({scene.file.string()}, "full.symmetry", "this parachute has no alike sectors",
                             why, "leave full.symmetry out");
        return sector;
    }
    auto gores = make_gore_layout(scene, mesh, constants, nullptr, threads);
    return gores ? std::move(gores) : make_unstructured_layout(scene, mesh, constants, nullptr, threads);
}

std::unique_ptr<Layout> make_reference_layout(const Mesh& mesh, const NodeConstants& constants) {
    return std::make_unique<ReferenceLayout>(mesh, constants);
}

}  // namespace twinchute::fullsim

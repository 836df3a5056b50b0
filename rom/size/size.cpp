#include "rom/size/size.hpp"

namespace twinchute::rom {
namespace {

Candidate candidate_of(const Scene& scene, const CanopyType* type, const std::vector<const VaryRow*>& vary,
                       const std::stop_token& stop) {
    Candidate candidate;
    Scene start = scene;
    if (type != nullptr) {
        candidate.type = type->name;
        if (!type->drag_coefficient || !type->drag_coefficient->may_be_default()) {
            candidate.why_not =
                "the catalogue has no drag coefficient of it that is more than a recollection";
            return candidate;
        }
        start = with_type(scene, *type, candidate.notes);
    } else if (sized_parachute(scene).type) {
        candidate.type = sized_parachute(scene).type->name;
    }
    candidate.found = search(start, vary, stop);
    candidate.notes.insert(candidate.notes.end(), candidate.found->notes.begin(),
                           candidate.found->notes.end());
    return candidate;
}

}  // namespace

const Candidate* Sized::best() const {
    const Candidate* best = nullptr;
    const auto better = [](const Candidate& one, const Candidate& other) {
        if (one.meets() != other.meets()) return one.meets();
        return one.meets() ? one.mass() < other.mass() : one.found->judged.used < other.found->judged.used;
    };
    for (const Candidate& candidate : candidates)
        if (candidate.found && (best == nullptr || better(candidate, *best))) best = &candidate;
    return best;
}

Sized size_scene(const Scene& scene, const std::stop_token& stop) {
    Sized sized;
    for (const std::string& name : scene.size->vary)
        sized.vary.push_back(find_vary(name));
    if (scene.size->types.empty()) sized.candidates.push_back(candidate_of(scene, nullptr, sized.vary, stop));
    for (const CanopyType& type : scene.size->types)
        sized.candidates.push_back(candidate_of(scene, &type, sized.vary, stop));
    return sized;
}

}  // namespace twinchute::rom

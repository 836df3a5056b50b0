#include "fullsim/mesh/gore_contacts.hpp"

namespace twinchute::fullsim {
namespace {

constexpr double stiffness_share = 0.25;  // of E t

}  // namespace

std::vector<ContactPair<NodeIndex>> gore_contacts(const Mesh& mesh) {
    std::vector<ContactPair<NodeIndex>> pairs;
    const double modulus = mesh.fabric.youngs_modulus * mesh.fabric.thickness;
    const std::size_t gores = mesh.seam_rings.front().size();
    for (std::size_t gore = 0; gore < gores; ++gore)
        for (const auto& seams : mesh.seam_rings) {
            // A row's nodes are numbered around, the first seam first.
            const int columns = seams[1] - seams[0];
            const NodeIndex seam = seams[gore], next = seams[(gore + 1) % gores];
            const double stiffness = stiffness_share * modulus / columns;
            pairs.push_back({{seam, next}, stiffness});
            for (int column = 1; column < columns; ++column) {
                pairs.push_back({{seam, seam + column}, stiffness});
                pairs.push_back({{seam + column, next}, stiffness});
            }
        }
    return pairs;
}

std::vector<ContactPair<LocalNode>> local_contacts(const Mesh& mesh, int gores,
                                                   const std::unordered_map<NodeIndex, LocalNode>& local) {
    const auto all = gore_contacts(mesh);
    const std::size_t count = all.size() / mesh.seam_rings.front().size() * static_cast<std::size_t>(gores);
    std::vector<ContactPair<LocalNode>> pairs;
    for (std::size_t k = 0; k < count; ++k)
        pairs.push_back({{local.at(all[k].node[0]), local.at(all[k].node[1])}, all[k].stiffness});
    return pairs;
}

}  // namespace twinchute::fullsim

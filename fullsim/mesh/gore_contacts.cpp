#include "fullsim/mesh/gore_contacts.hpp"

namespace twinchute::fullsim {

std::vector<ContactPair<NodeIndex>> gore_contacts(const Mesh& mesh) {
    std::vector<ContactPair<NodeIndex>> pairs;
    for_each_contact(mesh, [&](const ContactPair<NodeIndex>& pair) { pairs.push_back(pair); });
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

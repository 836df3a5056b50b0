#include "fullsim/mesh/node_order.hpp"

#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/cuthill_mckee_ordering.hpp>
#include <cmath>
#include <utility>

namespace twinchute::fullsim {

std::vector<FileNode> canopy_order(const ImportFile& file, std::vector<FileNode> nodes) {
    using Graph = boost::adjacency_list<boost::setS, boost::vecS, boost::undirectedS,
                                        boost::property<boost::vertex_color_t, boost::default_color_type>>;
    std::vector<std::size_t> place(file.nodes().size());  // of a node of the file among `nodes`
    for (std::size_t k = 0; k < nodes.size(); ++k)
        place[static_cast<std::size_t>(nodes[k])] = k;
    Graph edges(nodes.size());
    for (const GmshGroupIndex group : {group_canopy, group_gap})
        for (const GmshElement* e : file.elements_of(group))
            for (std::size_t c = 0; c < 3; ++c)
                boost::add_edge(place[static_cast<std::size_t>(e->node[c])],
                                place[static_cast<std::size_t>(e->node[(c + 1) % 3])], edges);

    std::vector<std::size_t> order(nodes.size()), number(nodes.size());
    boost::cuthill_mckee_ordering(edges, order.rbegin(), boost::get(boost::vertex_color, edges),
                                  boost::make_degree_map(edges));
    for (std::size_t k = 0; k < order.size(); ++k)
        number[order[k]] = k;
    double before = 0.0, after = 0.0;
    const auto apart = [](std::size_t a, std::size_t b) {
        return std::abs(static_cast<double>(a) - static_cast<double>(b));
    };
    for (const auto& e : boost::make_iterator_range(boost::edges(edges))) {
        const std::size_t a = e.m_source, b = e.m_target;
        before += apart(a, b);
        after += apart(number[a], number[b]);
    }
    const double all = static_cast<double>(boost::num_edges(edges) * nodes.size());
    if (8.0 * before < all || 2.0 * after > before) return nodes;
    std::vector<FileNode> ordered;
    for (const std::size_t k : order)
        ordered.push_back(nodes[k]);
    return ordered;
}

}  // namespace twinchute::fullsim

// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "grow/growing_tree.hpp"

namespace thalweg::grow {
namespace {

constexpr std::size_t looked_ahead = 16;  // links

/// The links in the order of their new numbers: along a stream from its mouth, then the tributaries met on the way.
std::vector<Index> downstream_first(const GrowingTree& tree) {
    std::vector<Index> order;
    order.reserve(tree.links.size());
    std::vector<Index> waiting{0};
    while (!waiting.empty()) {
        const Index mouth = waiting.back();
        waiting.pop_back();
        for (Index link = mouth; link != none; link = tree.links[link].upstream[0]) {
            order.push_back(link);
            const Index tributary = tree.links[link].upstream[1];
            if (tributary == none) continue;
            __builtin_prefetch(&tree.links[tributary]);
            waiting.push_back(tributary);
        }
    }
    return order;
}

/// New number of every vertex that still has an edge, `none` for the others.
std::vector<Index> number_vertices(const Subdivision& basin) {
    std::vector<Index> number(basin.vertices(), none);
    for (Index half_edge = 0; half_edge < basin.half_edges(); ++half_edge) {
        if (!basin.is_removed(half_edge)) number[basin.origin(half_edge)] = 0;
    }
    Index count = 0;
    for (Index& n : number) {
        if (n != none) n = count++;
    }
    return number;
}

void copy_plane(const Subdivision& basin, const std::vector<Index>& number, Network& network) {
    network.vertices.reserve(basin.vertices());
    network.edges.reserve(basin.half_edges() / 2);
    for (Index vertex = 0; vertex < basin.vertices(); ++vertex) {
        if (number[vertex] != none) network.vertices.push_back(basin.point(vertex));
    }
    for (Index half_edge = 0; half_edge < basin.half_edges(); half_edge += 2) {
        if (basin.is_removed(half_edge)) continue;
        network.edges.push_back(
            {number[basin.origin(half_edge)], number[basin.target(half_edge)], basin.kind(half_edge)});
    }
}

void copy_polygon(const Subdivision& basin, const std::vector<Index>& number, Index first, Network& network) {
    Index half_edge = first;
    do {
        network.polygon_vertices.push_back(number[basin.origin(half_edge)]);
        half_edge = basin.next(half_edge);
    } while (half_edge != first);
    network.polygon_offset.push_back(static_cast<Index>(network.polygon_vertices.size()));
    network.polygon_area_m2.push_back(basin.area(first));
}

void add_magnitudes(Network& network) {
    network.magnitude.assign(network.size(), 0);
    for (Index link = network.size(); link-- > 0;) {
        if (network.is_exterior(link)) network.magnitude[link] = 1;
        if (network.downstream[link] != none) network.magnitude[network.downstream[link]] += network.magnitude[link];
    }
}

void reserve_links(Index links, Index half_edges, Network& network) {
    network.downstream.reserve(links);
    network.upstream.reserve(links);
    network.lower.reserve(links);
    network.upper.reserve(links);
    network.stream.reserve(links);
    network.length_m.reserve(links);
    network.sidewall_slope.reserve(links);
    network.polygon_offset.reserve(2 * std::size_t{links} + 1);
    network.polygon_area_m2.reserve(2 * std::size_t{links});
    network.polygon_vertices.reserve(half_edges);
}

}  // namespace

Network finished(const GrowingTree& tree, const Point& origin) {
    Network network;
    network.origin = origin;
    const std::vector<Index> order = downstream_first(tree);
    std::vector<Index> renamed(order.size());
    for (Index link = 0; link < order.size(); ++link) renamed[order[link]] = link;
    const auto new_name = [&](Index link) { return link == none ? none : renamed[link]; };
    const std::vector<Index> number = number_vertices(tree.basin);
    copy_plane(tree.basin, number, network);
    reserve_links(static_cast<Index>(order.size()), tree.basin.half_edges(), network);
    network.polygon_offset.push_back(0);
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i % looked_ahead == 0) {
            fetch_ahead(tree, std::span(order).subspan(i, std::min(looked_ahead, order.size() - i)));
        }
        const GrowingLink& link = tree.links[order[i]];
        network.downstream.push_back(new_name(link.downstream));
        network.upstream.push_back({new_name(link.upstream[0]), new_name(link.upstream[1])});
        network.lower.push_back(number[tree.basin.origin(link.edge)]);
        network.upper.push_back(number[tree.basin.target(link.edge)]);
        network.stream.push_back(link.stream);
        network.length_m.push_back(link.length_m);
        network.sidewall_slope.push_back(link.sidewall_slope);
        copy_polygon(tree.basin, number, link.edge, network);
        copy_polygon(tree.basin, number, link.edge ^ 1, network);
    }
    add_magnitudes(network);
    network.junctions.reserve(tree.junctions.size());
    for (Junction junction : tree.junctions) {
        junction.tributary = renamed[junction.tributary];
        junction.downstream = network.downstream[junction.tributary];
        junction.upstream = network.upstream[junction.downstream][0];
        junction.vertex = number[junction.vertex];
        network.junctions.push_back(junction);
    }
    return network;
}

}  // namespace thalweg::grow

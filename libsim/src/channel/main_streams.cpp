// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/channel/main_streams.hpp"

#include <algorithm>

#include "channel/directions.hpp"

namespace thalweg::channel {

namespace {

/// The inflow with the largest claim carries on.
MainStreams streams_of(std::span<const Index> below, std::span<const double> claim) {
    const Index rows = static_cast<Index>(below.size());
    std::vector<Index> main_inflow(rows, none);
    for (Index row = 0; row < rows; ++row) {
        if (below[row] == none) continue;
        Index& chosen = main_inflow[below[row]];
        if (chosen == none || claim[row] > claim[chosen]) chosen = row;
    }
    MainStreams s;
    s.stream.resize(rows);
    for (Index row = 0; row < rows; ++row) {
        if (below[row] != none && main_inflow[below[row]] == row) {
            s.stream[row] = s.stream[below[row]];
            continue;
        }
        s.stream[row] = static_cast<Index>(s.parent.size());
        const Index parent = below[row] == none ? none : s.stream[below[row]];
        s.parent.push_back(parent);
        s.order.push_back(parent == none ? 1 : s.order[parent] + 1);
        s.outside.push_back(below[row]);
    }
    return s;
}

/// A piece of a river that is to be numbered: the link it ends with, and the links above which it does not go (`cut`:
/// the main inflow there belongs to the next piece up).
struct Piece {
    Index mouth;
    Index cut;  ///< lowest main-stream link that is no longer part of it; none: up to the sources
    std::int64_t code;
    int digits;
};

constexpr int most_digits = 18;

/// Links that flow into each link: of `downstream` the inverse, as compressed rows, largest area first.
struct Inflows {
    std::vector<Index> offset, link;

    explicit Inflows(const StreamNetwork& network) : offset(network.size() + 1, 0), link(network.size()) {
        for (const Index below : network.downstream) {
            if (below != none) ++offset[below + 1];
        }
        for (Index i = 0; i < network.size(); ++i) offset[i + 1] += offset[i];
        std::vector<Index> next(offset.begin(), offset.end() - 1);
        for (Index i = 0; i < network.size(); ++i) {
            if (network.downstream[i] != none) link[next[network.downstream[i]]++] = i;
        }
        for (Index i = 0; i < network.size(); ++i) {
            std::stable_sort(link.begin() + offset[i], link.begin() + offset[i + 1],
                             [&](Index a, Index b) { return network.area_m2[a] > network.area_m2[b]; });
        }
    }
    std::span<const Index> of(Index below) const {
        return std::span(link).subspan(offset[below], offset[below + 1] - offset[below]);
    }
};

/// The piece's main stream from its mouth up, and what joins it on the way.
struct Stem {
    std::vector<Index> links;
    struct Tributary {
        Index link;
        std::size_t above;  ///< it joins at the upper end of links[above]
    };
    std::vector<Tributary> tributaries;
};

/// `taken`: 1 at tributaries that are pieces of their own already (of several that join in one place some may not be).
Stem stem_of(const Piece& piece, const Inflows& inflows, std::span<const std::uint8_t> taken) {
    Stem stem;
    for (Index at = piece.mouth; at != none && at != piece.cut;) {
        stem.links.push_back(at);
        const auto in = inflows.of(at);
        at = none;
        if (in.empty()) break;
        for (const Index side : in.subspan(1)) {
            if (!taken[side]) stem.tributaries.push_back({side, stem.links.size() - 1});
        }
        at = in.front();
    }
    return stem;
}

/// The four largest, in the order in which they join; of two that join in one place the larger comes first.
void keep_four_largest(std::vector<Stem::Tributary>& tributaries, std::span<const double> area_m2) {
    if (tributaries.size() <= 4) return;
    std::vector<Stem::Tributary> by_size = tributaries;
    std::stable_sort(by_size.begin(), by_size.end(),
                     [&](const auto& a, const auto& b) { return area_m2[a.link] > area_m2[b.link]; });
    by_size.resize(4);
    std::erase_if(tributaries, [&](const auto& t) {
        return std::ranges::none_of(by_size, [&](const auto& kept) { return kept.link == t.link; });
    });
}

}  // namespace

MainStreams main_streams(const Profile& profile) { return streams_of(profile.below, profile.area_m2); }

MainStreams main_streams(const StreamNetwork& network) { return streams_of(network.downstream, network.area_m2); }

MainStreams straightest_streams(const StreamNetwork& network, const OffsetOf& offset, double reach_m) {
    std::vector<double> straightness(network.size(), 0);
    for (Index link = 0; link < network.size(); ++link) {
        const Index below = network.downstream[link];
        if (below == none) continue;
        straightness[link] = angle_between(downstream_direction(network.nodes_of(below), offset, reach_m),
                                           upstream_direction(network.nodes_of(link), offset, reach_m));
    }
    return streams_of(network.downstream, straightness);
}

std::vector<std::int64_t> pfafstetter_codes(const StreamNetwork& network) {
    const Inflows inflows(network);
    std::vector<std::int64_t> code(network.size(), 0);
    std::vector<std::uint8_t> taken(network.size(), 0);
    std::vector<Piece> open;
    for (Index link = 0; link < network.size(); ++link) {
        if (network.downstream[link] == none) open.push_back({link, none, 0, 0});
    }
    while (!open.empty()) {
        const Piece piece = open.back();
        open.pop_back();
        Stem stem = stem_of(piece, inflows, taken);
        for (const Index link : stem.links) code[link] = piece.code;
        if (piece.digits == most_digits) {
            for (const auto& t : stem.tributaries) open.push_back({t.link, none, piece.code, most_digits});
            continue;
        }
        if (stem.tributaries.empty()) continue;
        keep_four_largest(stem.tributaries, network.area_m2);
        Index mouth = piece.mouth;
        std::int64_t digit = 1;
        for (const auto& t : stem.tributaries) {
            taken[t.link] = 1;
            const bool last = t.above + 1 == stem.links.size();
            const Index next = last ? piece.cut : stem.links[t.above + 1];
            if (mouth != none && mouth != next)
                open.push_back({mouth, next, piece.code * 10 + digit, piece.digits + 1});
            open.push_back({t.link, none, piece.code * 10 + digit + 1, piece.digits + 1});
            mouth = next;
            digit += 2;
        }
        if (mouth != piece.cut) open.push_back({mouth, piece.cut, piece.code * 10 + digit, piece.digits + 1});
    }
    return code;
}

}  // namespace thalweg::channel

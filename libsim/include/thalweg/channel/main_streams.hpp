// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thalweg/channel/links.hpp"
#include "thalweg/channel/network.hpp"
#include "thalweg/channel/profile.hpp"

namespace thalweg::channel {

/// Rivers cut into main streams: at every junction the inflow with the largest drainage area (ties: the first) carries
/// on upstream, every other one begins a stream of its own. Streams are numbered so that a tributary comes after the
/// stream it joins.
struct MainStreams {
    std::vector<Index> stream;   ///< number of each row's stream
    std::vector<Index> parent;   ///< stream that each one joins, `none` where it ends at a base
    std::vector<Index> order;    ///< of each stream: 1 at a base, else its parent's + 1 (Gravelius 1914, Hack 1957)
    std::vector<Index> outside;  ///< row below each stream's lowest, which belongs to its parent; `none` at a base
};

MainStreams main_streams(const Profile&);
/// The same with links as rows.
MainStreams main_streams(const StreamNetwork&);

/// The same, but the inflow that goes straightest on carries on upstream: the one whose direction departs least from
/// that of the link below (Horton 1945), both taken over `reach_m` as for junction angles. Ties: the first.
MainStreams straightest_streams(const StreamNetwork&, const OffsetOf&, double reach_m);

/// Pfafstetter's code of each link (Verdin & Verdin 1999): of every river the four tributaries with the largest
/// drainage area are numbered 2, 4, 6 and 8 from the mouth up, the reaches of the main stream between them 1, 3, 5, 7
/// and 9, the headwaters last; each of the pieces is numbered again, a digit further, until its main stream has no
/// tributary. A river with fewer than four tributaries uses the lower numbers only; the link of a piece without a
/// tributary keeps the code it has, and 0 stands for a river without any. At most 18 digits; what lies deeper keeps the
/// digits it has. Codes are unique within one river (all that flows to one mouth) down to the last digit.
std::vector<std::int64_t> pfafstetter_codes(const StreamNetwork&);

}  // namespace thalweg::channel

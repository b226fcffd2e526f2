// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>

#include "thalweg/grow/basin.hpp"
#include "thalweg/grow/divides.hpp"
#include "thalweg/grow/links.hpp"

namespace thalweg::grow {

/// When a network is full-grown.
enum class Stop : std::uint8_t {
    density,  ///< the basin's area per channel length has come down to the constant of channel maintenance
    links     ///< no link can take a tributary any more
};

/// Whether an exterior link turns when it receives a tributary.
enum class UpstreamLink : std::uint8_t {
    keeps_line,
    turns  ///< by Howard's angle E2, away from the tributary
};

/// Where the three divides of a junction run.
enum class Divides : std::uint8_t {
    slopes,  ///< by the slopes of links and valley sides: `divide_direction`
    shares   ///< by drawn shares of the angle between the two links that each one parts
};

/// Mean and delta of a drawn value.
struct DrawnShare {
    double mean = 0.5;
    double delta = 0;
};

/// What shapes a network (Kelley, Malin & Nielson 1988). A drawn value is mean + Rand·delta, Rand uniform on [−1, 1].
struct Dials {
    double channel_maintenance_m = 500;  ///< C: area per channel length wanted, m; > 0
    double mean_junction = 0.5;          ///< place of a tributary on the link, from its lower end, 0–1
    double delta_junction = 0.25;        ///< 0–1
    double mean_length = 0.65;           ///< of a tributary, 1: reaches the polygon's edge; above 0, at most 1
    double delta_length = 0.2;           ///< 0–1
    Flint flint;                         ///< p in (0, 10], q in [−2, −0.05]
    double sidewall_angle_deg = 25;      ///< mean and delta together stay within 1–89
    double delta_sidewall_angle_deg = 5;
    double sidewall_reach_m = std::numeric_limits<double>::infinity();  ///< as of `Network`; > 0
    double lower_bias = 0.7;   ///< share of tributaries on the obtuse side of a stream's lower third, 0–1
    double middle_bias = 0.7;  ///< share opposite the next one downstream in its middle third, 0–1
    Divides divides = Divides::slopes;
    DrawnShare divide_across;  ///< from the downstream link to the upstream one, on the side without tributary
    DrawnShare divide_below;   ///< from the downstream link to the tributary
    DrawnShare divide_above;   ///< from the tributary to the upstream link
    UpstreamLink upstream_link = UpstreamLink::keeps_line;
    Stop stop = Stop::density;
    std::uint64_t seed = 1;
};

/// Throws Error, naming the dial, what it was and what it can be.
void check_dials(const Dials&);

enum class StopReason : std::uint8_t {
    density_reached,
    no_candidate,  ///< every link is as short, or its polygons as small, as they may be
    link_limit     ///< 1000 links and 400 for each square of C in the basin: dials that would shrink links to nothing
};

struct Growth {
    Network network;
    StopReason stopped;
    Index lengthened;    ///< times that a source moved on
    Index refused;       ///< links with no room for a tributary, though their polygons were large enough
    Index last_resorts;  ///< times that the rules were eased to meet the density
};

/// Grows a network from the trunk alone.
///
/// A trunk with bends first gets a junction at each of them, from the outlet up: the tributary on the outer side, as
/// above. Rivers bend where others join them; so the tree stays one of straight links. Divides halve the angles there;
/// one that would run into the trunk itself is turned until it does not.
///
/// The link with the largest excess A − C·L grows next (A its polygons' area, L its length; the older link on ties), if
/// it is above 0. An exterior link with more than C/2 of polygon beyond its source is lengthened by the drawn share
/// of that. Otherwise a link of at least C/5 gets a tributary: at the drawn place (kept in 0.05–0.95), at Howard's
/// angle for the magnitudes it has at that time, of the drawn share (0.05–0.95) of the way to the polygon's edge. Its
/// side: in the lower third of a stream the obtuse one with `lower_bias`, in the middle third the one opposite the next
/// tributary downstream with `middle_bias`, else even odds (Flint 1980); but never a side with less than C/2 of area
/// per length. No tributary is drawn shorter than C/10: four places are tried on that side and four on the other before
/// the link is refused. The last tributary is as long as is missing, so that the density is met.
///
/// Straight lines run into dead ends: a basin that goes on beside a link too short to be split. If the density is not
/// met when no link is left, exterior links may turn; after that the lengths C/5 and C/10 are halved, again and again
/// down to C/50 and C/100. `Growth::last_resorts` says how often this was needed.
///
/// Three divides leave each junction (see `Divides`; drawn shares are kept in 0.1–0.9) and run to the nearest side of
/// the polygon. A ray that passes a vertex within 1e-9·C ends there.
///
/// The same seed gives the same network to the last bit. Cost: N log N steps for N links (the magnitudes at a junction
/// are counts in a balanced sequence of the sources; the rays walk around their polygon, whose sides do not grow in
/// number with N). Measured: 0.9 µs per link at 1e4 links, 1.2 at 1e5, 1.5 at 1e6, which is N^1.1 as N log N is.
/// Throws Error for what `checked_basin` and `check_dials` refuse, for a trunk that alone makes the channels denser
/// than C (stop = density), for a bend whose tributary or divides cannot reach the basin's edge past the trunk's other
/// bends, and for more than 1e8 C² of basin.
Growth grow(const Basin&, const Dials&);

/// Throws the Error that `grow` would throw before anything grows.
void check_trunk(const Basin&, const Dials&);

/// The same, which leaves copies of the network behind as it grows.
struct Stages {
    std::vector<Index> links;       ///< ascending: a copy is taken as soon as there are so many or more
    std::vector<Network> networks;  ///< copies; fewer than asked for where a network does not grow as large
};
Growth grow(const Basin&, const Dials&, Stages&);

}  // namespace thalweg::grow

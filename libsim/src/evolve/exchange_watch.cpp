// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/evolve/exchange_watch.hpp"

#include <algorithm>

namespace thalweg::evolve {

ExchangeWatch exchange_watch(Index nodes, Index patience) {
    ExchangeWatch watch;
    watch.patience = patience;
    watch.last_change.assign(nodes, 0);
    return watch;
}

Index observe(ExchangeWatch& watch, const FlowDirections& directions) {
    ++watch.step;
    Index changes = 0;
    for (Index node = 0; node < watch.before.size(); ++node) {
        if (directions[node] == watch.before[node]) continue;
        ++changes;
        Index& last = watch.last_change[node];
        const bool quiet = last == 0 || watch.step - last > watch.patience;
        if (quiet) watch.last_new_change = watch.step;
        last = watch.step;
    }
    if (changes > 0) watch.last_any_change = watch.step;
    watch.before.assign(directions.begin(), directions.end());
    return changes;
}

bool only_the_same(const ExchangeWatch& watch) {
    return watch.last_any_change != 0 && watch.step >= watch.last_new_change + watch.patience &&
           watch.step < watch.last_any_change + watch.patience;
}

void freeze(ExchangeWatch& watch) {
    watch.frozen.resize(watch.last_change.size(), no_flow);
    for (Index node = 0; node < watch.last_change.size(); ++node) {
        const Index last = watch.last_change[node];
        if (last != 0 && watch.step - last < watch.patience) watch.frozen[node] = watch.before[node];
    }
    watch.last_new_change = watch.step;
}

Index frozen_count(const ExchangeWatch& watch) {
    const auto free = std::ranges::count(watch.frozen, no_flow);
    return static_cast<Index>(static_cast<std::ptrdiff_t>(watch.frozen.size()) - free);
}

std::vector<std::uint8_t> frozen_mask(const ExchangeWatch& watch) {
    std::vector<std::uint8_t> mask(watch.last_change.size(), 0);
    for (Index node = 0; node < watch.frozen.size(); ++node) mask[node] = watch.frozen[node] != no_flow;
    return mask;
}

}  // namespace thalweg::evolve

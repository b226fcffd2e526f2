// SPDX-License-Identifier: GPL-3.0-or-later
#include "evolve/exchange_watch.hpp"

#include <algorithm>

namespace thalweg::evolve {

Index ExchangeWatch::observe(const FlowDirections& directions) {
    ++step_;
    Index changes = 0;
    for (Index node = 0; node < before_.size(); ++node) {
        if (directions[node] == before_[node]) continue;
        ++changes;
        const bool quiet = last_change_[node] == 0 || step_ - last_change_[node] > patience_;
        if (quiet) last_new_change_ = step_;
        last_change_[node] = step_;
    }
    if (changes > 0) last_any_change_ = step_;
    before_.assign(directions.begin(), directions.end());
    return changes;
}

bool ExchangeWatch::only_the_same() const {
    return last_any_change_ != 0 && step_ >= last_new_change_ + patience_ && step_ < last_any_change_ + patience_;
}

void ExchangeWatch::freeze() {
    frozen_.resize(last_change_.size(), no_flow);
    for (Index node = 0; node < last_change_.size(); ++node) {
        if (last_change_[node] != 0 && step_ - last_change_[node] < patience_) frozen_[node] = before_[node];
    }
    last_new_change_ = step_;
}

Index ExchangeWatch::frozen_count() const {
    const auto free = std::ranges::count(frozen_, no_flow);
    return static_cast<Index>(static_cast<std::ptrdiff_t>(frozen_.size()) - free);
}

std::vector<std::uint8_t> ExchangeWatch::frozen_mask() const {
    std::vector<std::uint8_t> mask(last_change_.size(), 0);
    for (Index node = 0; node < frozen_.size(); ++node) mask[node] = frozen_[node] != no_flow;
    return mask;
}

}  // namespace thalweg::evolve

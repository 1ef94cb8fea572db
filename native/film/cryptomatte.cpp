// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/cryptomatte.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace spc {

void add_coverage(std::span<CryptoSlot> slots, float id, uint32_t weight) {
    if (id == 0.0f) return;
    for (CryptoSlot& slot : slots) {
        if (slot.weight != 0 && slot.id != id) continue;
        slot.id = id;
        slot.weight += weight;
        return;
    }
}

void Coverage::add(const CryptoIds& ids, float share) {
    const float units = std::min(std::max(share, 0.0f), 1.0f) / kCryptoUnit;
    const auto weight = static_cast<uint32_t>(std::lround(units));
    if (weight > 0 && count_ < kMost) parts_[count_++] = {ids, weight};
}

std::array<float, 4> crypto_level(std::span<const CryptoSlot> slots, uint32_t level,
                                  uint32_t samples) {
    std::vector<CryptoSlot> ranked(slots.begin(), slots.end());
    // By identifier where shares are equal, so that the order of samples does not show.
    std::sort(ranked.begin(), ranked.end(), [](const CryptoSlot& a, const CryptoSlot& b) {
        return a.weight != b.weight ? a.weight > b.weight : a.id > b.id;
    });
    std::array<float, 4> result{};
    for (size_t i = 0; i < 2; ++i) {
        const size_t rank = size_t{2} * level + i;
        if (rank >= ranked.size() || samples == 0) break;
        result[2 * i] = ranked[rank].id;
        result[2 * i + 1] =
            static_cast<float>(ranked[rank].weight) * kCryptoUnit / static_cast<float>(samples);
    }
    return result;
}

}  // namespace spc

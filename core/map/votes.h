// Counting for things of a table, and marking them, without a hash table.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/map/id_table.h"

namespace vpslam {

/// Counts per id, of what is in the table. The table must not change meanwhile.
template <class Id, class T>
class Votes {
 public:
  explicit Votes(const IdTable<Id, T>& table)
      : table_(table), counts_(static_cast<size_t>(table.num_slots()), 0) {}

  void Add(Id id) {
    const int32_t slot = table_.Slot(id);
    if (slot < 0) return;
    if (counts_[static_cast<size_t>(slot)]++ == 0) voted_.push_back(id);
  }
  int Of(Id id) const {
    const int32_t slot = table_.Slot(id);
    return slot < 0 ? 0 : counts_[static_cast<size_t>(slot)];
  }
  /// With their votes, most first, ties by id.
  std::vector<std::pair<Id, int>> Ranked() const {
    std::vector<std::pair<Id, int>> ranked;
    ranked.reserve(voted_.size());
    for (const Id id : voted_) ranked.emplace_back(id, Of(id));
    std::sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) {
      return a.second != b.second ? a.second > b.second : a.first < b.first;
    });
    return ranked;
  }

 private:
  const IdTable<Id, T>& table_;
  std::vector<int> counts_;
  std::vector<Id> voted_;
};

/// A set of ids of what is in the table. The table must not change meanwhile.
template <class Id, class T>
class Marks {
 public:
  explicit Marks(const IdTable<Id, T>& table)
      : table_(table), marked_(static_cast<size_t>(table.num_slots()), 0) {}

  /// False if it was marked before, or is not in the table.
  bool Insert(Id id) {
    const int32_t slot = table_.Slot(id);
    return slot >= 0 && std::exchange(marked_[static_cast<size_t>(slot)], uint8_t{1}) == 0;
  }
  bool Contains(Id id) const {
    const int32_t slot = table_.Slot(id);
    return slot >= 0 && marked_[static_cast<size_t>(slot)] != 0;
  }

 private:
  const IdTable<Id, T>& table_;
  std::vector<uint8_t> marked_;
};

}  // namespace vpslam

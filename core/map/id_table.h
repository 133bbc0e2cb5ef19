// Things by typed id. Ids come in increasing order, session by session, and most of the things that
// are made are gone again before long: the table holds what lives and nothing else.
//
// Things stay where they are in memory until they are erased. They are visited in the order of
// their ids, so that no result depends on the order of a hash table.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

namespace vpslam {

template <class Id, class T>
class IdTable {
 public:
  /// nullptr if there is none of this id.
  const T* Find(Id id) const {
    const int32_t slot = Slot(id);
    return slot < 0 ? nullptr : &At(slot);
  }
  T* Find(Id id) { return const_cast<T*>(std::as_const(*this).Find(id)); }

  /// A small number that belongs to the id as long as the thing lives, for arrays beside the table;
  /// -1 if there is none of this id. All are below num_slots().
  int32_t Slot(Id id) const {
    if (!id.IsValid()) return -1;
    const auto session = static_cast<size_t>(id.session());
    if (session >= sessions_.size()) return -1;
    const std::vector<Page>& pages = sessions_[session];
    const auto page = static_cast<size_t>(id.index()) / kPageSize;
    if (page >= pages.size() || pages[page].slots.empty()) return -1;
    return pages[page].slots[static_cast<size_t>(id.index()) % kPageSize];
  }
  int32_t num_slots() const { return num_slots_; }

  int32_t size() const { return size_; }
  bool empty() const { return size_ == 0; }

  /// A new one, with its default values; one that is there already is returned as it is.
  T& Insert(Id id) {
    const auto session = static_cast<size_t>(id.session());
    if (session >= sessions_.size()) sessions_.resize(session + 1);
    std::vector<Page>& pages = sessions_[session];
    const auto page = static_cast<size_t>(id.index()) / kPageSize;
    if (page >= pages.size()) pages.resize(page + 1);
    if (pages[page].slots.empty()) pages[page].slots.assign(kPageSize, -1);
    int32_t& slot = pages[page].slots[static_cast<size_t>(id.index()) % kPageSize];
    if (slot < 0) {
      slot = NewSlot();
      ++pages[page].used;
      ++size_;
    }
    return At(slot);
  }

  /// Nothing happens if there is none of this id.
  void Erase(Id id) {
    const int32_t slot = Slot(id);
    if (slot < 0) return;
    Page& page =
        sessions_[static_cast<size_t>(id.session())][static_cast<size_t>(id.index()) / kPageSize];
    page.slots[static_cast<size_t>(id.index()) % kPageSize] = -1;
    if (--page.used == 0) page.slots = {};
    At(slot) = T();
    free_slots_.push_back(slot);
    --size_;
  }

  /// Visits all things by ascending id. Erasing the one at hand is allowed, inserting is not.
  class Iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = const T;
    using difference_type = std::ptrdiff_t;
    using pointer = const T*;
    using reference = const T&;

    Iterator(const IdTable* table, size_t session) : table_(table), session_(session) { Settle(); }
    reference operator*() const {
      return table_->At(table_->sessions_[session_][page_].slots[index_]);
    }
    pointer operator->() const { return &**this; }
    Iterator& operator++() {
      ++index_;
      Settle();
      return *this;
    }
    Iterator operator++(int) {
      Iterator before = *this;
      ++*this;
      return before;
    }
    bool operator==(const Iterator& other) const = default;

   private:
    /// Goes on to the first thing from here.
    void Settle() {
      for (; session_ < table_->sessions_.size(); ++session_, page_ = 0) {
        const std::vector<Page>& pages = table_->sessions_[session_];
        for (; page_ < pages.size(); ++page_, index_ = 0) {
          const std::vector<int32_t>& slots = pages[page_].slots;
          while (index_ < slots.size() && slots[index_] < 0) ++index_;
          if (index_ < slots.size()) return;
        }
      }
    }
    const IdTable* table_;
    size_t session_ = 0, page_ = 0, index_ = 0;
  };
  Iterator begin() const { return Iterator(this, 0); }
  Iterator end() const { return Iterator(this, sessions_.size()); }

 private:
  static constexpr size_t kPageSize = 256;
  static constexpr size_t kChunkSize = 128;

  /// The slots of ids that follow each other; empty while none of them is in use.
  struct Page {
    std::vector<int32_t> slots;
    int32_t used = 0;
  };

  const T& At(int32_t slot) const {
    return chunks_[static_cast<size_t>(slot) / kChunkSize][static_cast<size_t>(slot) % kChunkSize];
  }
  T& At(int32_t slot) { return const_cast<T&>(std::as_const(*this).At(slot)); }

  int32_t NewSlot() {
    if (!free_slots_.empty()) {
      const int32_t slot = free_slots_.back();
      free_slots_.pop_back();
      return slot;
    }
    if (static_cast<size_t>(num_slots_) == chunks_.size() * kChunkSize) {
      chunks_.emplace_back(kChunkSize);
    }
    return num_slots_++;
  }

  std::vector<std::vector<Page>> sessions_;
  std::vector<std::vector<T>> chunks_;  ///< each of kChunkSize from the start: nothing ever moves
  std::vector<int32_t> free_slots_;
  int32_t num_slots_ = 0;
  int32_t size_ = 0;
};

}  // namespace vpslam

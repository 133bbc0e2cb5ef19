#include "core/transport/image_pool.h"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <map>
#include <set>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace vpslam {
namespace {

constexpr uint64_t kMagic = 0x3130'6c6f'6f70'7076;  // "vppool01"
constexpr std::size_t kAlignment = 64;
constexpr std::size_t kMaxSegmentBytes = std::size_t{1} << 32;

// The segment: SegmentHead, then per slot a SlotHead and slot_bytes of pixels, all of it aligned.
struct alignas(kAlignment) SegmentHead {
  uint64_t magic;
  uint64_t slots;
  uint64_t slot_bytes;  // a multiple of kAlignment
};

struct alignas(kAlignment) SlotHead {
  std::atomic<int64_t> generation;  // odd while the slot is written
  std::atomic<int64_t> size;        // bytes
};
static_assert(std::atomic<int64_t>::is_always_lock_free, "shared between processes");

std::size_t Align(std::size_t bytes) { return (bytes + kAlignment - 1) / kAlignment * kAlignment; }

std::size_t SegmentBytes(uint64_t slots, uint64_t slot_bytes) {
  return sizeof(SegmentHead) + slots * (sizeof(SlotHead) + slot_bytes);
}

SlotHead* SlotAt(void* segment, uint64_t slot_bytes, int slot) {
  return reinterpret_cast<SlotHead*>(static_cast<uint8_t*>(segment) + sizeof(SegmentHead) +
                                     slot * (sizeof(SlotHead) + slot_bytes));
}

uint8_t* PixelsOf(SlotHead* slot) { return reinterpret_cast<uint8_t*>(slot + 1); }

void CopyPixels(const cv::Mat& pixels, uint8_t* to) {
  for (int row = 0; row < pixels.rows; ++row) {
    std::memcpy(to + static_cast<std::size_t>(row) * pixels.cols, pixels.ptr(row), pixels.cols);
  }
}

void CheckPixels(const cv::Mat& pixels) {
  if (pixels.type() != CV_8UC1 || pixels.empty()) {
    throw std::runtime_error("an image to be sent must be grey, 8 bits per pixel, and not empty");
  }
}

ImageMessage DescribeImage(const ImageFrame& frame) {
  ImageMessage message;
  message.frame_seq = frame.frame_seq;
  message.stamp_us = frame.stamp_us;
  message.published_us = frame.published_us;
  message.decode_ms = frame.decode_ms;
  message.width = frame.pixels.cols;
  message.height = frame.pixels.rows;
  return message;
}

}  // namespace

std::string ImageSegmentName(int64_t session) { return fmt::format("/vpslam-{}", session); }

ImageMessage InlineImage(const ImageFrame& frame) {
  CheckPixels(frame.pixels);
  ImageMessage message = DescribeImage(frame);
  message.bytes.resize(frame.pixels.total());
  CopyPixels(frame.pixels, message.bytes.data());
  return message;
}

class ImagePool::Impl {
 public:
  Impl(const std::string& segment, int slots, std::size_t slot_bytes)
      : segment_(segment), slots_(slots), slot_bytes_(Align(slot_bytes)) {
    if (!IsImageSegmentName(segment)) {
      throw std::runtime_error("'" + segment + "' is no name for shared memory; try /vpslam-1");
    }
    if (slots < 1 || slots > 65536 || slot_bytes == 0 || slot_bytes > kMaxSegmentBytes) {
      throw std::runtime_error("an image pool needs slots and a size for them");
    }
    bytes_ = SegmentBytes(slots, slot_bytes_);
    shm_unlink(segment.c_str());
    const int fd = shm_open(segment.c_str(), O_CREAT | O_EXCL | O_RDWR, 0600);
    if (fd < 0) Fail("cannot create");
    // Reserves the memory: a full /dev/shm shows here and not as SIGBUS in the middle of a run.
    if (const int error = posix_fallocate(fd, 0, static_cast<off_t>(bytes_)); error != 0) {
      close(fd);
      shm_unlink(segment.c_str());
      errno = error;
      Fail("not enough room for");
    }
    memory_ = mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    close(fd);
    if (memory_ == MAP_FAILED) {
      shm_unlink(segment.c_str());
      Fail("cannot map");
    }
    new (memory_) SegmentHead{kMagic, static_cast<uint64_t>(slots), slot_bytes_};
    for (int i = 0; i < slots; ++i) new (SlotAt(memory_, slot_bytes_, i)) SlotHead{{0}, {0}};
  }

  ~Impl() {
    munmap(memory_, bytes_);
    shm_unlink(segment_.c_str());
  }

  ImageMessage Store(const ImageFrame& frame) {
    CheckPixels(frame.pixels);
    const std::size_t size = frame.pixels.total();
    if (size > slot_bytes_) {
      throw std::runtime_error(
          fmt::format("an image of {} bytes does not fit into slots of {}", size, slot_bytes_));
    }
    SlotHead* slot = SlotAt(memory_, slot_bytes_, next_);
    const int64_t generation = slot->generation.load(std::memory_order_relaxed);
    slot->generation.store(generation + 1, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_release);
    slot->size.store(static_cast<int64_t>(size), std::memory_order_relaxed);
    CopyPixels(frame.pixels, PixelsOf(slot));
    slot->generation.store(generation + 2, std::memory_order_release);

    ImageMessage message = DescribeImage(frame);
    message.segment = segment_;
    message.slot = next_;
    message.generation = generation + 2;
    next_ = (next_ + 1) % slots_;
    return message;
  }

 private:
  [[noreturn]] void Fail(const char* what) const {
    throw std::runtime_error(fmt::format("{} shared memory {} of {} MB ({}); make room in /dev/shm",
                                         what, segment_, bytes_ / 1'000'000, std::strerror(errno)));
  }

  const std::string segment_;
  const int slots_;
  const std::size_t slot_bytes_;
  std::size_t bytes_ = 0;
  void* memory_ = nullptr;
  int next_ = 0;
};

ImagePool::ImagePool(const std::string& segment, int slots, std::size_t slot_bytes)
    : impl_(std::make_unique<Impl>(segment, slots, slot_bytes)) {}
ImagePool::~ImagePool() = default;
ImageMessage ImagePool::Store(const ImageFrame& frame) { return impl_->Store(frame); }

class ImageFetcher::Impl {
 public:
  ~Impl() {
    for (auto& [name, mapping] : mappings_) munmap(mapping.memory, mapping.bytes);
  }

  std::optional<ImageFrame> Fetch(const ImageMessage& message, std::string* why) {
    ImageFrame frame;
    frame.frame_seq = message.frame_seq;
    frame.stamp_us = message.stamp_us;
    frame.published_us = message.published_us;
    frame.decode_ms = message.decode_ms;
    frame.pixels.create(message.height, message.width, CV_8UC1);
    const std::size_t size = frame.pixels.total();
    if (message.segment.empty()) {
      if (message.bytes.size() != size) {
        *why = "number of bytes does not fit width x height";
        return std::nullopt;
      }
      std::memcpy(frame.pixels.data, message.bytes.data(), size);
      return frame;
    }
    const Mapping* mapping = Find(message.segment, why);
    if (!mapping) return std::nullopt;
    if (message.slot < 0 || static_cast<uint64_t>(message.slot) >= mapping->slots) {
      *why = "no such slot in " + message.segment;
      return std::nullopt;
    }
    SlotHead* slot = SlotAt(mapping->memory, mapping->slot_bytes, message.slot);
    const int64_t generation = slot->generation.load(std::memory_order_acquire);
    if (generation == message.generation) {
      if (slot->size.load(std::memory_order_relaxed) != static_cast<int64_t>(size)) {
        *why = "the slot holds an image of another size";
        return std::nullopt;
      }
      std::memcpy(frame.pixels.data, PixelsOf(slot), size);
      std::atomic_thread_fence(std::memory_order_acquire);
    }
    if (generation != message.generation ||
        slot->generation.load(std::memory_order_relaxed) != message.generation) {
      *why = "the slot was used again before the image was copied";
      return std::nullopt;
    }
    return frame;
  }

 private:
  struct Mapping {
    void* memory;
    std::size_t bytes;
    uint64_t slots;
    uint64_t slot_bytes;
  };

  const Mapping* Find(const std::string& segment, std::string* why) {
    const auto found = mappings_.find(segment);
    if (found != mappings_.end()) return &found->second;
    const std::optional<Mapping> mapping = Map(segment, why);
    if (!mapping) return nullptr;
    // A player that was started again uses a segment of its own: the old one is of no use any more.
    constexpr std::size_t kMaxMappings = 8;
    if (mappings_.size() >= kMaxMappings) {
      munmap(mappings_.begin()->second.memory, mappings_.begin()->second.bytes);
      mappings_.erase(mappings_.begin());
    }
    return &mappings_.emplace(segment, *mapping).first->second;
  }

  static std::optional<Mapping> Map(const std::string& segment, std::string* why) {
    if (!IsImageSegmentName(segment)) {
      *why = "alien name of a shared memory segment";
      return std::nullopt;
    }
    const int fd = shm_open(segment.c_str(), O_RDONLY, 0);
    if (fd < 0) {
      *why = fmt::format(
          "shared memory {} cannot be opened ({}); a player on another host needs "
          "--inline",
          segment, std::strerror(errno));
      return std::nullopt;
    }
    struct stat status {};
    const bool known = fstat(fd, &status) == 0;
    const auto bytes = static_cast<std::size_t>(std::max<off_t>(status.st_size, 0));
    if (!known || bytes < sizeof(SegmentHead) || bytes > kMaxSegmentBytes) {
      close(fd);
      *why = "shared memory " + segment + " has an impossible size";
      return std::nullopt;
    }
    void* memory = mmap(nullptr, bytes, PROT_READ, MAP_SHARED, fd, 0);
    close(fd);
    if (memory == MAP_FAILED) {
      *why = "shared memory " + segment + " cannot be mapped";
      return std::nullopt;
    }
    const auto* head = static_cast<const SegmentHead*>(memory);
    const uint64_t slots = head->slots;
    const uint64_t slot_bytes = head->slot_bytes;
    if (head->magic != kMagic || slots == 0 || slots > 65536 || slot_bytes == 0 ||
        slot_bytes > kMaxSegmentBytes || slot_bytes % kAlignment != 0 ||
        SegmentBytes(slots, slot_bytes) > bytes) {
      munmap(memory, bytes);
      *why = "shared memory " + segment + " holds no image pool";
      return std::nullopt;
    }
    return Mapping{memory, bytes, slots, slot_bytes};
  }

  std::map<std::string, Mapping> mappings_;
};

ImageFetcher::ImageFetcher() : impl_(std::make_unique<Impl>()) {}
ImageFetcher::~ImageFetcher() = default;
std::optional<ImageFrame> ImageFetcher::Fetch(const ImageMessage& message, std::string* why) {
  return impl_->Fetch(message, why);
}

}  // namespace vpslam

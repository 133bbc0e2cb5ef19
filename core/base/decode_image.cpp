#include "core/base/decode_image.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <opencv2/imgcodecs.hpp>

namespace vpslam {
namespace {

/// True for a JPEG without an end-of-image marker behind its pixels. In entropy-coded data 0xFF is
/// followed by 0 or a restart marker only, so FF D9 behind the first start-of-scan is that marker;
/// before it, a thumbnail may have one of its own (ITU-T T.81, B.1.1).
bool IsTruncatedJpeg(const std::vector<uint8_t>& bytes) {
  const size_t n = bytes.size();
  if (n < 4 || bytes[0] != 0xFF || bytes[1] != 0xD8) return false;
  size_t at = 2;
  while (at + 4 <= n && bytes[at] == 0xFF && bytes[at + 1] != 0xDA) {
    at += 2 + (static_cast<size_t>(bytes[at + 2]) << 8 | bytes[at + 3]);
  }
  for (size_t i = n - 2; i > at; --i) {
    if (bytes[i] == 0xFF && bytes[i + 1] == 0xD9) return false;
  }
  return true;
}

/// True for a PNG without its closing chunk.
bool IsTruncatedPng(const std::vector<uint8_t>& bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  return text.starts_with("\x89PNG") && text.rfind("IEND") == std::string_view::npos;
}

/// The largest value that a PGM or PPM announces, and that OpenCV 4.6 leaves as it is; 0 for other
/// files, for small numbers written as text, which it brings to 255, and for 65535, which programs
/// write whatever the content is.
int MaxvalOfPnm(const std::vector<uint8_t>& bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()),
                              std::min<size_t>(bytes.size(), 4096));
  if (text.size() < 3 || text[0] != 'P' || std::string_view("2356").find(text[1]) == text.npos) {
    return 0;
  }
  int numbers = 0, value = 0;
  bool in_number = false, in_comment = false;
  for (const char c : text.substr(2)) {
    if (in_comment) {
      in_comment = c != '\n';
    } else if (c >= '0' && c <= '9') {
      value = (in_number ? 10 * value : 0) + (c - '0');
      in_number = true;
      if (value > 65535) return 0;
    } else {
      if (in_number && ++numbers == 3)
        return value == 65535 || (value < 256 && text[1] < '5') ? 0 : value;
      in_number = false;
      in_comment = c == '#';
    }
  }
  return 0;
}

struct Decoded {
  cv::Mat pixels;  ///< grey, of whatever depth
  int maxval = 0;  ///< that the file announces; 0: it does not
  std::string fault;
};

Decoded Decode(const std::string& path) {
  std::error_code unknown;
  // Which can be opened, and claims to be of any size.
  if (std::filesystem::is_directory(path, unknown)) return {{}, 0, "is a folder"};
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return {{}, 0, "is missing or cannot be opened"};
  const std::streamoff size = file.tellg();
  if (size <= 0) return {{}, 0, "is empty"};
  std::vector<uint8_t> bytes(static_cast<size_t>(size));
  file.seekg(0);
  if (!file.read(reinterpret_cast<char*>(bytes.data()), size)) return {{}, 0, "cannot be read"};
  if (IsTruncatedJpeg(bytes) || IsTruncatedPng(bytes)) return {{}, 0, "is truncated"};
  Decoded result;
  try {
    result.pixels = cv::imdecode(
        bytes, cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    // Sizes beyond OpenCV's limits, for instance; the same to the caller as any other fault.
  }
  result.maxval = MaxvalOfPnm(bytes);
  if (result.pixels.empty()) {
    result.fault = "is truncated or no image";
  } else if (result.pixels.depth() > CV_16U) {
    result.fault = "has floating-point pixels; convert the images to 8 or 16 bits";
  }
  return result;
}

using Histogram = std::vector<int64_t>;  // by value

void Count(const cv::Mat& pixels, Histogram* histogram) {
  for (int v = 0; v < pixels.rows; ++v) {
    const auto* row = pixels.ptr<uint16_t>(v);
    for (int u = 0; u < pixels.cols; ++u) ++(*histogram)[row[u]];
  }
}

/// The value below which the share lies.
int Quantile(const Histogram& histogram, double share) {
  int64_t sum = 0, total = 0;
  for (const int64_t count : histogram) total += count;
  for (size_t value = 0; value < histogram.size(); ++value) {
    sum += histogram[value];
    if (static_cast<double>(sum) > share * static_cast<double>(total)) {
      return static_cast<int>(value);
    }
  }
  return static_cast<int>(histogram.size()) - 1;
}

GreyRange RangeOf(const Histogram& histogram) {
  constexpr double kTail = 0.001, kHot = 1e-4;  // hot and dead pixels
  const int most = Quantile(histogram, 1 - kHot);
  int high = 255;
  while (high < most) high = 2 * high + 1;
  const int low = Quantile(histogram, kTail), top = Quantile(histogram, 1 - kTail);
  if (8 * (top - low) >= high || top - low < 16) return {0, high};
  const int margin = (top - low) / 10;
  return {std::max(0, low - margin), std::min(65535, top + margin)};
}

}  // namespace

DecodedImage DecodeGrey(const std::string& path, const GreyRange& deep) {
  Decoded decoded = Decode(path);
  DecodedImage result;
  result.fault = std::move(decoded.fault);
  if (!result.fault.empty()) return result;
  GreyRange range = deep;
  if (decoded.maxval > 0) {
    range = {0, decoded.maxval};
  } else if (decoded.pixels.depth() == CV_8U) {
    range = {0, 255};
  } else if (deep.high == 0) {
    Histogram histogram(65536, 0);
    Count(decoded.pixels, &histogram);
    range = RangeOf(histogram);
  }
  if (decoded.pixels.depth() == CV_8U && range.high == 255) {
    result.grey = std::move(decoded.pixels);
    return result;
  }
  const double scale = 255.0 / std::max(1, range.high - range.low);
  decoded.pixels.convertTo(result.grey, CV_8U, scale, -scale * range.low);
  return result;
}

DeepPixels LookForDeepPixels(const std::vector<std::string>& paths) {
  DeepPixels result;
  Histogram histogram;
  for (const std::string& path : paths) {
    const Decoded decoded = Decode(path);
    if (!decoded.fault.empty() || decoded.pixels.depth() == CV_8U) continue;
    if (result.path.empty()) {
      result.path = path;
      histogram.assign(65536, 0);
    }
    if (decoded.maxval > 0) {
      result.range = {0, decoded.maxval};
      return result;
    }
    Count(decoded.pixels, &histogram);
  }
  if (!result.path.empty()) result.range = RangeOf(histogram);
  return result;
}

}  // namespace vpslam

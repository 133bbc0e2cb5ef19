#include "core/base/decode_image.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>
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

}  // namespace

DecodedImage DecodeGrey(const std::string& path) {
  std::error_code unknown;
  // Which can be opened, and claims to be of any size.
  if (std::filesystem::is_directory(path, unknown)) return {{}, "is a folder"};
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return {{}, "is missing or cannot be opened"};
  const std::streamoff size = file.tellg();
  if (size <= 0) return {{}, "is empty"};
  std::vector<uint8_t> bytes(static_cast<size_t>(size));
  file.seekg(0);
  if (!file.read(reinterpret_cast<char*>(bytes.data()), size)) return {{}, "cannot be read"};
  if (IsTruncatedJpeg(bytes) || IsTruncatedPng(bytes)) return {{}, "is truncated"};
  DecodedImage result;
  try {
    result.grey = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    // Sizes beyond OpenCV's limits, for instance; the same to the caller as any other fault.
  }
  if (result.grey.empty()) result.fault = "is truncated or no image";
  return result;
}

}  // namespace vpslam

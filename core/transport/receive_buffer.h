// The kernel's share in what gets lost: a receive buffer that is smaller than what is under way.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace vpslam {

/// The bytes of receive buffer that a complete URL asks for; nullopt where it is no udpm.
std::optional<int> AskedReceiveBuffer(const std::string& url);

/// What the kernel gives a socket that asks for so many bytes; it may cap it. 0 if there are none.
int GrantedReceiveBuffer(int asked_bytes);

/// One line with the remedy, if messages with images of `image_bytes`, `window` of them under way,
/// do not fit into the receive buffer. The host of this process stands for those of the readers.
std::optional<std::string> WhyInlineImagesGetLost(int asked_bytes, int granted_bytes,
                                                  std::size_t image_bytes, int window);

}  // namespace vpslam

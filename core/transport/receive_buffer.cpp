#include "core/transport/receive_buffer.h"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/transport/bus.h"

namespace vpslam {

std::optional<int> AskedReceiveBuffer(const std::string& url) {
  constexpr const char* kKey = "recv_buf_size=";
  const size_t at = url.find(kKey);
  if (url.rfind("udpm://", 0) != 0 || at == std::string::npos) return std::nullopt;
  return std::atoi(url.c_str() + at + std::string_view(kKey).size());
}

int GrantedReceiveBuffer(int asked_bytes) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) return 0;
  int doubled = 0;
  socklen_t size = sizeof doubled;
  const bool known = setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &asked_bytes, sizeof asked_bytes) == 0 &&
                     getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &doubled, &size) == 0;
  close(fd);
  return known ? doubled / 2 : 0;  // the kernel counts its own bookkeeping as well
}

std::optional<std::string> WhyInlineImagesGetLost(int asked_bytes, int granted_bytes,
                                                  std::size_t image_bytes, int window) {
  // One fragment that does not fit loses the whole image; other messages need room, too.
  constexpr std::size_t kOtherMessages = 64'000;
  const std::size_t needed = image_bytes * static_cast<std::size_t>(window) + kOtherMessages;
  if (static_cast<std::size_t>(std::max(0, granted_bytes)) >= needed) return std::nullopt;
  const std::size_t wanted =
      std::max(needed, static_cast<std::size_t>(BusOptions().receive_buffer));
  const std::string remedy =
      granted_bytes < asked_bytes
          ? fmt::format("the kernel caps it there: type 'sysctl -w net.core.rmem_max={}' as root",
                        wanted)
          : fmt::format("ask for more: recv_buf_size={} in the LCM URL", wanted);
  return fmt::format(
      "images of {} kB travel in the messages (--inline), and with a receive buffer of {} kB many "
      "of "
      "them get lost; {}, or leave out --inline",
      image_bytes / 1000, granted_bytes / 1000, remedy);
}

}  // namespace vpslam

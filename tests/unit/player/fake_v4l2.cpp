// A camera for tests, preloaded (LD_PRELOAD) into a program that opens V4L2 devices: the file that
// VPSLAM_FAKE_CAMERA names becomes one. Like usual USB cameras it takes raw images (YUYV) unless it
// is asked for MJPG, and has 30 of those a second, but 10 raw ones of 1280 x 720 px.
//
// VPSLAM_FAKE_JPEG: file with the picture that MJPG shows. VPSLAM_FAKE_FORMATS: "YUYV" takes MJPG
// away. VPSLAM_FAKE_SIZE: "640x480" is all it gives. VPSLAM_FAKE_STALL: it never delivers.
#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <dlfcn.h>
#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/timerfd.h>
#include <unistd.h>

namespace {

constexpr uint32_t kBufferBytes = 4 << 20;
constexpr int64_t kDelay_us = 30'000;  // from taking a picture to handing it out

struct Camera {
  int fd = -1;  // a timer, which can be read when a picture is due
  uint32_t width = 640, height = 480, format = V4L2_PIX_FMT_YUYV;
  uint32_t asked_rate_hz = 30;
  uint32_t sequence = 0;
  std::vector<std::vector<uint8_t>> buffers;
  std::vector<uint32_t> queued;
};
Camera camera;

template <class F>
F Real(const char* name) {
  return reinterpret_cast<F>(dlsym(RTLD_NEXT, name));
}

bool IsCamera(const char* path) {
  const char* fake = std::getenv("VPSLAM_FAKE_CAMERA");
  return fake && std::strcmp(path, fake) == 0;
}

uint32_t Rate_hz() {
  const bool slow = camera.format == V4L2_PIX_FMT_YUYV && camera.width * camera.height > 640 * 480;
  return std::min(camera.asked_rate_hz, slow ? 10u : 30u);
}

void Reset() {
  camera.width = 640;
  camera.height = 480;
  camera.format = V4L2_PIX_FMT_YUYV;
  camera.asked_rate_hz = 30;
  camera.sequence = 0;
  camera.buffers.clear();
  camera.queued.clear();
}

void SetFormat(v4l2_format* format) {
  v4l2_pix_format& pix = format->fmt.pix;
  const char* formats = std::getenv("VPSLAM_FAKE_FORMATS");
  const bool has_mjpg = !formats || std::strstr(formats, "MJPG");
  if (pix.pixelformat != V4L2_PIX_FMT_MJPEG || !has_mjpg) pix.pixelformat = V4L2_PIX_FMT_YUYV;
  if (const char* size = std::getenv("VPSLAM_FAKE_SIZE")) {
    std::sscanf(size, "%ux%u", &pix.width, &pix.height);
  }
  pix.width = std::clamp(pix.width, 160u, 1280u);
  pix.height = std::clamp(pix.height, 120u, 720u);
  pix.field = V4L2_FIELD_NONE;
  pix.bytesperline = pix.pixelformat == V4L2_PIX_FMT_YUYV ? 2 * pix.width : 0;
  pix.sizeimage = kBufferBytes;
  pix.colorspace = V4L2_COLORSPACE_SRGB;
}

void GetFormat(v4l2_format* format) {
  format->fmt.pix = {};
  format->fmt.pix.width = camera.width;
  format->fmt.pix.height = camera.height;
  format->fmt.pix.pixelformat = camera.format;
  SetFormat(format);
}

uint32_t Fill(std::vector<uint8_t>* buffer) {
  if (camera.format == V4L2_PIX_FMT_MJPEG) {
    std::ifstream file(std::getenv("VPSLAM_FAKE_JPEG"), std::ios::binary);
    const std::string jpeg{std::istreambuf_iterator<char>(file), {}};
    std::copy(jpeg.begin(), jpeg.end(), buffer->begin());
    return static_cast<uint32_t>(jpeg.size());
  }
  std::fill(buffer->begin(), buffer->end(), uint8_t{128});
  return 2 * camera.width * camera.height;
}

int Dequeue(v4l2_buffer* buffer) {
  uint64_t ticks = 0;
  if (std::getenv("VPSLAM_FAKE_STALL") || camera.queued.empty() ||
      read(camera.fd, &ticks, sizeof ticks) < 0) {
    errno = EAGAIN;
    return -1;
  }
  buffer->index = camera.queued.front();
  camera.queued.erase(camera.queued.begin());
  buffer->length = kBufferBytes;
  buffer->bytesused = Fill(&camera.buffers[buffer->index]);
  buffer->flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  buffer->sequence = camera.sequence++;
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  const int64_t taken_us = now.tv_sec * int64_t{1'000'000} + now.tv_nsec / 1000 - kDelay_us;
  buffer->timestamp.tv_sec = taken_us / 1'000'000;
  buffer->timestamp.tv_usec = taken_us % 1'000'000;
  return 0;
}

int Ioctl(unsigned long request, void* argument) {
  switch (request) {
    case VIDIOC_QUERYCAP: {
      auto* capability = static_cast<v4l2_capability*>(argument);
      *capability = {};
      std::strcpy(reinterpret_cast<char*>(capability->driver), "fake");
      capability->capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
      return 0;
    }
    case VIDIOC_G_INPUT:
      *static_cast<int*>(argument) = 0;
      return 0;
    case VIDIOC_S_INPUT:
      return 0;
    case VIDIOC_ENUMINPUT: {
      auto* input = static_cast<v4l2_input*>(argument);
      if (input->index > 0) break;
      input->type = V4L2_INPUT_TYPE_CAMERA;
      return 0;
    }
    case VIDIOC_G_FMT:
      GetFormat(static_cast<v4l2_format*>(argument));
      return 0;
    case VIDIOC_TRY_FMT:
      SetFormat(static_cast<v4l2_format*>(argument));
      return 0;
    case VIDIOC_S_FMT: {
      auto* format = static_cast<v4l2_format*>(argument);
      SetFormat(format);
      camera.width = format->fmt.pix.width;
      camera.height = format->fmt.pix.height;
      camera.format = format->fmt.pix.pixelformat;
      return 0;
    }
    case VIDIOC_S_PARM:
    case VIDIOC_G_PARM: {
      auto* parameters = static_cast<v4l2_streamparm*>(argument);
      v4l2_captureparm& capture = parameters->parm.capture;
      if (request == VIDIOC_S_PARM && capture.timeperframe.numerator > 0) {
        camera.asked_rate_hz = capture.timeperframe.denominator / capture.timeperframe.numerator;
      }
      capture.capability = V4L2_CAP_TIMEPERFRAME;
      capture.timeperframe = {1, Rate_hz()};
      return 0;
    }
    case VIDIOC_REQBUFS: {
      auto* buffers = static_cast<v4l2_requestbuffers*>(argument);
      camera.buffers.assign(buffers->count, std::vector<uint8_t>());
      camera.queued.clear();
      return 0;
    }
    case VIDIOC_QUERYBUF: {
      auto* buffer = static_cast<v4l2_buffer*>(argument);
      buffer->length = kBufferBytes;
      buffer->m.offset = buffer->index * kBufferBytes;
      return 0;
    }
    case VIDIOC_QBUF:
      camera.queued.push_back(static_cast<v4l2_buffer*>(argument)->index);
      return 0;
    case VIDIOC_DQBUF:
      return Dequeue(static_cast<v4l2_buffer*>(argument));
    case VIDIOC_STREAMON: {
      const long period_ns = std::getenv("VPSLAM_FAKE_STALL") ? 0 : 1'000'000'000 / Rate_hz();
      const itimerspec timer{{0, period_ns}, {0, period_ns}};
      return timerfd_settime(camera.fd, 0, &timer, nullptr);
    }
    case VIDIOC_STREAMOFF:
      return 0;
    default:
      break;
  }
  errno = EINVAL;
  return -1;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  if (IsCamera(path)) {
    Reset();
    camera.fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
    return camera.fd;
  }
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = (flags & O_CREAT) ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  return Real<int (*)(const char*, int, ...)>("open")(path, flags, mode);
}

int ioctl(int fd, unsigned long request, ...) noexcept {
  va_list arguments;
  va_start(arguments, request);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  if (fd >= 0 && fd == camera.fd) return Ioctl(request, argument);
  return Real<int (*)(int, unsigned long, ...)>("ioctl")(fd, request, argument);
}

void* mmap(void* address, size_t length, int protection, int flags, int fd, off_t offset) noexcept {
  if (fd >= 0 && fd == camera.fd) {
    const auto index = static_cast<size_t>(offset) / kBufferBytes;
    camera.buffers[index].resize(kBufferBytes);
    return camera.buffers[index].data();
  }
  return Real<void* (*)(void*, size_t, int, int, int, off_t)>("mmap")(address, length, protection,
                                                                      flags, fd, offset);
}

int munmap(void* address, size_t length) noexcept {
  for (const auto& buffer : camera.buffers) {
    if (!buffer.empty() && buffer.data() == address) return 0;
  }
  return Real<int (*)(void*, size_t)>("munmap")(address, length);
}

int close(int fd) {
  if (fd >= 0 && fd == camera.fd) camera.fd = -1;
  return Real<int (*)(int)>("close")(fd);
}

}  // extern "C"

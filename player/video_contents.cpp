#include "player/video_contents.h"

#include <cstdarg>
#include <cstdio>
#include <memory>
#include <mutex>

extern "C" {
#include <libavformat/avformat.h>
#include <libavutil/log.h>
}

namespace vpslam {
namespace {

struct Close {
  void operator()(AVFormatContext* context) const { avformat_close_input(&context); }
};

std::mutex complaints_mutex;
int64_t complaints_count = 0;
std::string complaints_first;

void NoteComplaint(void* source, int level, const char* format, va_list arguments) {
  if (level > AV_LOG_ERROR) return;
  char line[512];
  int print_prefix = 1;
  va_list copy;
  va_copy(copy, arguments);
  av_log_format_line2(source, level, format, copy, line, sizeof line, &print_prefix);
  va_end(copy);
  const std::lock_guard lock(complaints_mutex);
  if (complaints_count++ > 0) return;
  complaints_first = line;
  while (!complaints_first.empty() && complaints_first.back() == '\n') complaints_first.pop_back();
}

}  // namespace

VideoContents ReadVideoContents(const std::string& path) {
  VideoContents contents;
  AVFormatContext* opened = nullptr;
  if (avformat_open_input(&opened, path.c_str(), nullptr, nullptr) < 0) return contents;
  const std::unique_ptr<AVFormatContext, Close> context(opened);
  if (avformat_find_stream_info(opened, nullptr) < 0) return contents;
  const int index = av_find_best_stream(opened, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  if (index < 0) return contents;
  AVStream* stream = opened->streams[index];
  if (stream->duration > 0) {
    contents.duration_s = static_cast<double>(stream->duration) * av_q2d(stream->time_base);
  } else if (opened->duration > 0) {
    contents.duration_s = static_cast<double>(opened->duration) / AV_TIME_BASE;
  }
  if (stream->nb_frames <= 0) return contents;
  // What an edit list leaves out is marked in the index.
  const int entries = avformat_index_get_entries_count(stream);
  int64_t shown = stream->nb_frames;
  for (int i = 0; i < entries; ++i) {
    const AVIndexEntry* entry = avformat_index_get_entry(stream, i);
    shown -= (entry->flags & AVINDEX_DISCARD_FRAME) != 0;
  }
  contents.frames = shown;
  return contents;
}

FfmpegComplaints::FfmpegComplaints() {
  const std::lock_guard lock(complaints_mutex);
  complaints_count = 0;
  complaints_first.clear();
  Listen();
}

void FfmpegComplaints::Listen() { av_log_set_callback(NoteComplaint); }

FfmpegComplaints::~FfmpegComplaints() { av_log_set_callback(av_log_default_callback); }

int64_t FfmpegComplaints::count() const {
  const std::lock_guard lock(complaints_mutex);
  return complaints_count;
}

std::string FfmpegComplaints::first() const {
  const std::lock_guard lock(complaints_mutex);
  return complaints_first;
}

}  // namespace vpslam

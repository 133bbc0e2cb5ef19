// A source whose camera gets a mask: --mask, for whatever kind of source.
#pragma once

#include <memory>
#include <string>

#include "player/image_source.h"

namespace vpslam {

/// `source` with the mask of that file in its camera, in place of one that it has. Throws
/// std::runtime_error with one line if the file is no mask of its images' size.
std::unique_ptr<ImageSource> WithMask(std::unique_ptr<ImageSource> source,
                                      const std::string& mask_file);

}  // namespace vpslam

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <glog/logging.h>

namespace thalweg::infer {

/// Ceres speaks through glog even when it is told to be silent; what matters reaches the user as an Error.
inline void keep_ceres_quiet() { FLAGS_minloglevel = google::FATAL; }

}  // namespace thalweg::infer

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/fusion_config.hpp"
#include "pipeline/codec.hpp"
#include "pipeline/prior_stage.hpp"
#include "segmentation/segmentation_config.hpp"
#include "sensing/device_config.hpp"

namespace rf {

/// rf-capture: the codec's fields, and the device's as a section.
struct CaptureConfig : CodecOptions {
  DeviceConfig device;

  template <class V>
  void visit(V& v) {
    CodecOptions::visit(v);
    v("device", device, "OpenNI2 devices and .oni files");
  }
};

/// Every parameter of the pipeline: one YAML file for all processes and the offline run.
struct PipelineConfig {
  CaptureConfig capture;
  PriorConfig prior;
  SegmentationConfig segmentation;
  FusionConfig fusion;

  template <class V>
  void visit(V& v) {
    v("capture", capture, "rf-capture: codec and device");
    v("prior", prior, "rf-prior: motion priors");
    v("segmentation", segmentation, "rf-segment: motion segmentation");
    v("fusion", fusion, "rf-fuse: mapping and frame-to-model tracking");
  }
};

}  // namespace rf

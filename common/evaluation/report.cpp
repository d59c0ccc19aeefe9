// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/report.hpp"

#include <numbers>

#include <fmt/format.h>

namespace rf {
namespace {

constexpr double kCm = 100.0;
constexpr double kDeg = 180.0 / std::numbers::pi;

std::string row(const char* name, const std::optional<TrajectoryScore>& s) {
  if (!s) return {};
  return fmt::format("{:<13} {:>8.2f} {:>8.2f} {:>8.2f} {:>9.2f} {:>9.2f} {:>8.1f} {:>6}/{}\n",
                     name, kCm * s->ate_first.rmse, kCm * s->ate_aligned.rmse,
                     kCm * s->ate_first.max, kCm * s->rpe.translation.rmse,
                     kDeg * s->rpe.rotation.rmse, 100.0 * s->coverage, s->posed, s->frames);
}

std::string row(const std::string& name, const std::optional<SegmentationScore>& s) {
  if (!s) return {};
  return fmt::format("{:<19} {:>6} {:>7} {:>7.3f} {:>7.3f} {:>7.3f} {:>7.3f} {:>8.3f} {:>8.3f}\n",
                     name, s->frames, s->missing, s->iou, s->iou_mean, s->iou_median, s->iou_min,
                     s->static_accuracy, s->dynamic_accuracy);
}

std::string row(const char* name, const std::optional<ModelScore>& s) {
  if (!s) return {};
  return fmt::format("{:<13} {:>9} {:>9.2f} {:>9.2f} {:>9.1f} {:>9.1f}\n", name, s->model_points,
                     kCm * s->accuracy_median, kCm * s->accuracy_rmse, 100.0 * s->accuracy_share,
                     100.0 * s->completeness);
}

std::string json(const ErrorStatistics& s, double unit) {
  return fmt::format(
      R"({{"count": {}, "rmse": {:.6f}, "mean": {:.6f}, "median": {:.6f}, "max": {:.6f}}})",
      s.count, unit * s.rmse, unit * s.mean, unit * s.median, unit * s.max);
}

std::string row(const char* name, const std::optional<Consistency>& s) {
  if (!s) return {};
  std::string text = fmt::format("{:<13} {:>7}", name, s->samples);
  for (const Nees* n : {&s->pose, &s->translation, &s->rotation}) {
    text += fmt::format(" {:>7.2f} {:>7.2f} {:>6.1f}", n->mean, n->median, 100 * n->share_above_95);
  }
  return text + fmt::format(" {:>8} {:>6}\n", s->tracked, s->misplaced);
}

std::string json(const Nees& n) {
  return fmt::format(R"({{"mean": {:.6f}, "median": {:.6f}, "share_above_95": {:.6f}}})", n.mean,
                     n.median, n.share_above_95);
}

std::string json(const std::optional<Consistency>& s) {
  if (!s) return "null";
  return fmt::format(R"({{"samples": {}, "pose": {}, "translation": {}, "rotation": {}, )"
                     R"("tracked": {}, "misplaced": {}}})",
                     s->samples, json(s->pose), json(s->translation), json(s->rotation), s->tracked,
                     s->misplaced);
}

std::string json(const std::optional<TrajectoryScore>& s,
                 const std::optional<Consistency>& consistency = std::nullopt) {
  if (!s) return "null";
  return fmt::format(
      R"({{"ate_first_cm": {}, "ate_aligned_cm": {}, "rpe_cm_per_s": {}, "rpe_deg_per_s": {}, )"
      R"("frames": {}, "posed": {}, "matched": {}, "coverage": {:.6f}, "nees": {}}})",
      json(s->ate_first, kCm), json(s->ate_aligned, kCm), json(s->rpe.translation, kCm),
      json(s->rpe.rotation, kDeg), s->frames, s->posed, s->matched, s->coverage, json(consistency));
}

std::string json(const std::optional<SegmentationScore>& s) {
  if (!s) return "null";
  return fmt::format(R"({{"frames": {}, "missing": {}, "iou": {:.6f}, "iou_mean": {:.6f}, )"
                     R"("iou_median": {:.6f}, "iou_min": {:.6f}, "static_accuracy": {:.6f}, )"
                     R"("dynamic_accuracy": {:.6f}}})",
                     s->frames, s->missing, s->iou, s->iou_mean, s->iou_median, s->iou_min,
                     s->static_accuracy, s->dynamic_accuracy);
}

std::string json(const std::optional<ModelScore>& s) {
  if (!s) return "null";
  return fmt::format(
      R"({{"model_points": {}, "truth_points": {}, "accuracy_median_cm": {:.6f}, )"
      R"("accuracy_rmse_cm": {:.6f}, "accuracy_share": {:.6f}, "completeness": {:.6f}}})",
      s->model_points, s->truth_points, kCm * s->accuracy_median, kCm * s->accuracy_rmse,
      s->accuracy_share, s->completeness);
}

std::string jsonSelf(const std::optional<PixelCounts>& s) {
  if (!s) return "null";
  return fmt::format(R"({{"recall": {:.6f}, "precision": {:.6f}, "right": {}, "missed": {}, )"
                     R"("wrong": {}}})",
                     s->selfRecall(), s->selfPrecision(), s->self_right, s->self_missed,
                     s->self_wrong);
}

std::string json(const std::optional<MapOnMoving>& s) {
  if (!s) return "null";
  return fmt::format(R"({{"frames": {}, "surfels": {}, "on_moving": {}, "share": {:.6f}}})",
                     s->frames, s->surfels, s->on_moving, s->share());
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out + "\"";
}

}  // namespace

std::string toText(const EvaluationReport& r) {
  std::string text;
  if (r.camera || r.object || r.camera_prior || r.object_prior) {
    text += fmt::format("{:<13} {:>8} {:>8} {:>8} {:>9} {:>9} {:>8} {}\n", "trajectory", "ATE 1st",
                        "ATE SE3", "max 1st", "RPE", "RPE", "poses", "poses/frames");
    text += fmt::format("{:<13} {:>8} {:>8} {:>8} {:>9} {:>9} {:>8}\n", "", "cm", "cm", "cm",
                        "cm/s", "deg/s", "%");
    text += row("camera", r.camera) + row("camera prior", r.camera_prior);
    text += row("object", r.object) + row("object prior", r.object_prior);
  }
  if (r.camera_consistency || r.object_consistency) {
    text += fmt::format("\n{:<13} {:>7} {:^22} {:^22} {:^22} {:>8} {:>6}\n", "NEES / dof", "frames",
                        "pose", "translation", "rotation", "tracked", "but");
    text += fmt::format("{:<21}", "");
    for (int i = 0; i < 3; ++i)
      text += fmt::format(" {:>7} {:>7} {:>6}", "mean", "median", ">95 %");
    text += fmt::format(" {:>8} {:>6}\n", "frames", ">10cm");
    text += row("camera", r.camera_consistency) + row("object", r.object_consistency);
  }
  if (r.fast || r.moving) {
    text +=
        fmt::format("\n{:<19} {:>6} {:>7} {:>7} {:>7} {:>7} {:>7} {:>8} {:>8}\n", "segmentation",
                    "frames", "missing", "IoU", "mean", "median", "min", "acc.stat", "acc.dyn");
    text += row(fmt::format("object > {:.1f} cm/s", kCm * r.speed_threshold), r.fast);
    text += row(std::string("object moves"), r.moving);
  }
  if (r.self) {
    text += fmt::format("\n{:<19} {:>8} {:>10}\n{:<19} {:>8.3f} {:>10.3f}\n", "robot's own pixels",
                        "recall", "precision", "self-filter", r.self->selfRecall(),
                        r.self->selfPrecision());
  }
  if (r.static_model || r.object_model) {
    text += fmt::format("\n{:<13} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "model", "surfels", "median cm",
                        "rmse cm", "< 2cm %", "compl. %");
    text += row("static", r.static_model) + row("object", r.object_model);
  }
  if (r.static_on_moving) {
    const MapOnMoving& s = *r.static_on_moving;
    text +=
        fmt::format("\nstatic model on dynamic pixels of {} frames: {} of {} surfels, {:.1f} %\n",
                    s.frames, s.on_moving, s.surfels, 100.0 * s.share());
  }
  for (const std::string& note : r.notes) text += "note: " + note + "\n";
  return text;
}

std::string toJson(const EvaluationReport& r) {
  std::string notes;
  for (const std::string& note : r.notes) notes += (notes.empty() ? "" : ", ") + quoted(note);
  const auto entry = [](const char* key, const std::string& value) {
    return fmt::format("  \"{}\": {},\n", key, value);
  };
  return "{\n" + entry("camera", json(r.camera, r.camera_consistency)) +
         entry("camera_prior", json(r.camera_prior)) +
         entry("object", json(r.object, r.object_consistency)) +
         entry("object_prior", json(r.object_prior)) +
         entry("speed_threshold_m_per_s", fmt::format("{}", r.speed_threshold)) +
         entry("segmentation_fast", json(r.fast)) + entry("segmentation_moving", json(r.moving)) +
         entry("self_filter", jsonSelf(r.self)) + entry("static_model", json(r.static_model)) +
         entry("object_model", json(r.object_model)) +
         entry("static_on_moving", json(r.static_on_moving)) + "  \"notes\": [" + notes + "]\n}\n";
}

}  // namespace rf

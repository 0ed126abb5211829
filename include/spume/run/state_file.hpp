// SPDX-License-Identifier: MIT
// The state of a method as arrays of a checkpoint, under a common prefix.
#pragma once

#include <string>

#include "spume/io/checkpoint.hpp"
#include "spume/methods/method.hpp"

namespace spume {

class CheckpointStateWriter final : public StateWriter {
 public:
  CheckpointStateWriter(CheckpointWriter& file, std::string prefix) : file_(file), prefix_(std::move(prefix)) {}
  void f64(const std::string& name, std::span<const double> values) override { file_.f64(prefix_ + name, values); }
  void i64(const std::string& name, std::span<const std::int64_t> values) override {
    file_.i64(prefix_ + name, values);
  }

 private:
  CheckpointWriter& file_;
  std::string prefix_;
};

class CheckpointStateReader final : public StateReader {
 public:
  CheckpointStateReader(const CheckpointReader& file, std::string prefix) : file_(file), prefix_(std::move(prefix)) {}
  void f64(const std::string& name, Array<double>& values) override { file_.f64(prefix_ + name, values); }
  void i64(const std::string& name, Array<std::int64_t>& values) override { file_.i64(prefix_ + name, values); }

 private:
  const CheckpointReader& file_;
  std::string prefix_;
};

}  // namespace spume

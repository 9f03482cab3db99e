// SPDX-License-Identifier: Apache-2.0
// Keeps its inputs of every cycle in memory and writes them as a CSV file when killed. README.md is the data sheet.
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "chimera/task/component.h"

using namespace chimera;

namespace {

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

double number_at(const std::byte* at, std::uint32_t type) noexcept {
  const auto as = [at]<class T>(T value) {
    std::memcpy(&value, at, sizeof value);
    return static_cast<double>(value);
  };
  switch (type) {
    case CHIMERA_BOOL: return as(std::uint8_t{});
    case CHIMERA_INT32: return as(std::int32_t{});
    case CHIMERA_INT64: return as(std::int64_t{});
    case CHIMERA_FLOAT32: return as(float{});
    default: return as(double{});
  }
}

struct CsvLog {
  Many<In<Any[]>>       in{"in*", "U", "[n<=16]", type = "T", doc = "What is kept: numbers or truth values."};
  InConst<std::int32_t> capacity{"capacity", "1", initial = 10000, range(1, 1000000), doc = "Rows there is room for."};
  Out<std::int32_t>     rows{"rows", "1", initial = 0, doc = "Rows kept."};
  Out<std::int64_t>     lost{"lost", "1", initial = 0, doc = "Rows that found no room."};
  Resource              file{"file", doc = "The file to write; what was in it is lost."};

  void init() {
    check_inputs();
    file_.reset(std::fopen(file.c_str(), "w"));
    if (!file_) throw std::runtime_error(file.c_str() + std::string(": ") + std::strerror(errno));
    // Filled, not reserved: the first touch of a page is a fault of the memory, and that belongs here.
    values_.assign(columns() * static_cast<std::size_t>(*capacity), 0.0);
    used_ = 0;
  }
  void on(Cycle c) {
    if (used_ == 0) origin_ = c.now();
  }
  void cycle(Cycle c) {
    if (used_ + columns() > values_.size()) {
      *lost += 1;
      return;
    }
    values_[used_++] = static_cast<double>((c.now() - origin_).count) * 1e-9;
    for (const auto& port : in) {
      const std::span<const std::byte> bytes = port.bytes();
      for (std::size_t i = 0; i < port.size(); ++i)
        values_[used_++] = port.valid() ? number_at(bytes.data() + i * port.element_size(), port.element_type())
                                        : std::nan("");
    }
    *rows += 1;
  }
  // Not in off(): that runs between the cycles of others and may not wait for a disk.
  Outcome kill() {
    if (!file_) return ok();
    write_header();
    for (std::size_t i = 0; i < used_; ++i) {
      if (i % columns() != 0) std::fputc(',', file_.get());
      if (!std::isnan(values_[i])) std::fprintf(file_.get(), "%.15g", values_[i]);
      if ((i + 1) % columns() == 0) std::fputc('\n', file_.get());
    }
    const bool is_written = std::ferror(file_.get()) == 0 && std::fclose(file_.release()) == 0;
    return is_written ? ok() : fault("the file could not be written");
  }

 private:
  void check_inputs() const {
    if (in.size() == 0) throw std::runtime_error("there is nothing to log: name at least one input");
    for (const auto& port : in)
      if (port.element_type() > CHIMERA_FLOAT64) throw std::runtime_error("texts and structs cannot be logged");
  }
  std::size_t columns() const noexcept {
    std::size_t count = 1;
    for (const auto& port : in) count += port.size();
    return count;
  }
  // A component does not know the names of the variables it is joined to.
  void write_header() const {
    std::fputc('t', file_.get());
    for (std::size_t p = 0; p < in.size(); ++p)
      for (std::size_t i = 0; i < in[p].size(); ++i)
        if (in[p].size() == 1) std::fprintf(file_.get(), ",in[%zu]", p);
        else std::fprintf(file_.get(), ",in[%zu][%zu]", p, i);
    std::fputc('\n', file_.get());
  }

  std::unique_ptr<std::FILE, CloseFile> file_;
  std::vector<double> values_;  // row by row
  std::size_t used_ = 0;
  Nanoseconds origin_;
};

CHIMERA_COMPONENT(CsvLog, "csv_log", "Keeps its inputs of every cycle and writes a CSV file at the end.");

}  // namespace

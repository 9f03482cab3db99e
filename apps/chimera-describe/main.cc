// SPDX-License-Identifier: Apache-2.0
// chimera-describe OBJECT.so --output FILE
// Build tool: derives NAME.component.json from a component's object and prints the methods it found. This is the
// only place where component code runs to describe itself: its static constructors and one sample instance.
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>

#include "chimera/catalogue/descriptor_json.h"
#include "chimera/catalogue/library.h"
#include "chimera/load/component_state.h"
#include "chimera/load/shared_object.h"
#include "chimera/task/signal.h"

namespace chimera {
namespace {

int refuse(const std::string& path, std::string_view why) {
  std::fprintf(stderr, "%s: %.*s\n", path.c_str(), static_cast<int>(why.size()), why.data());
  return 1;
}

/// "lib/gain.so" -> "gain"
std::string stem(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::string file = slash == std::string::npos ? path : path.substr(slash + 1);
  return file.substr(0, file.find('.'));
}

bool write_file(const std::string& path, const std::string& text) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (file == nullptr) return false;
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  return std::fclose(file) == 0 && written;
}

void print_methods(const Descriptor& descriptor) {
  std::printf("%s:", descriptor.name.c_str());
  for (std::uint32_t i = 0; i < CHIMERA_METHODS; ++i)
    if (descriptor.methods[i]) std::printf(" %s", method_name(static_cast<Method>(i)));
  std::printf("%s%s\n", descriptor.background ? "; background" : "",
              descriptor.event_source ? "; event_source" : "");
}

/// The first unit that is unknown, with the port; "": all are known, or there is no unit file to judge by.
std::string wrong_unit(const Descriptor& descriptor) {
  std::error_code none;
  const auto prefix = std::filesystem::read_symlink("/proc/self/exe", none).parent_path().parent_path();
  const std::string files[] = {prefix / "share/chimera/units.xml", prefix / "../../share/chimera/units.xml"};
  auto units = UnitSystem::load(files);
  if (!units) return {};
  const Library library = Library::of({descriptor}, *std::move(units));
  return library.faults().empty() ? std::string() : std::string(library.faults()[0].message.view());
}

int describe_object(const std::string& object, const std::string& output) {
  const auto opened = SharedObject::open(object);
  if (!opened) return refuse(object, opened.error().message.view());
  if (opened->components().size() != 1) return refuse(object, "offers several components: give each its own object");
  const auto component = opened->component(stem(object));
  if (!component) return refuse(object, component.error().message.view());
  // A sample shows what the declaration cannot: a constructor that fails, a port that is no member.
  const auto sample = ComponentState::make(**component);
  if (!sample) return refuse(object, sample.error().message.view());
  const auto descriptor = describe(**component);
  if (!descriptor) return refuse(object, descriptor.error().message.view());
  if (const std::string wrong = wrong_unit(*descriptor); !wrong.empty()) return refuse(object, wrong);
  if (!write_file(output, to_json(*descriptor))) return refuse(output, std::strerror(errno));
  print_methods(*descriptor);
  return 0;
}

}  // namespace
}  // namespace chimera

int main(int argc, char** argv) {
  if (argc != 4 || std::strcmp(argv[2], "--output") != 0) {
    std::fprintf(stderr, "usage: chimera-describe OBJECT.so --output FILE\n");
    return 2;
  }
  return chimera::describe_object(argv[1], argv[3]);
}

// SPDX-License-Identifier: Apache-2.0
#include "chimera/base/hosted/ordinary_file.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <fstream>

namespace chimera {
namespace {

class OrdinaryFile : public ::testing::Test {
 protected:
  OrdinaryFile() {
    char made[] = "/tmp/chimera-ordinary-XXXXXX";
    folder_ = ::mkdtemp(made);
  }
  ~OrdinaryFile() override {
    for (const char* name : {"file", "pipe", "socket"}) ::unlink(at(name).c_str());
    ::rmdir(folder_.c_str());
  }
  std::string at(const char* name) const { return folder_ + "/" + name; }
  static std::string said(const std::string& path) {
    const auto text = read_ordinary(path, 10);
    return text ? *text : std::string(text.error().message.view());
  }

  std::string folder_;
};

TEST_F(OrdinaryFile, IsReadUpToTheLimit) {
  std::ofstream(at("file")) << "123456789012345";
  EXPECT_EQ(said(at("file")), "1234567890");
  EXPECT_EQ(*read_ordinary(at("file"), 100), "123456789012345");
}

TEST_F(OrdinaryFile, IsNoPipeFolderDeviceOrSocket) {
  ASSERT_EQ(::mkfifo(at("pipe").c_str(), 0600), 0);
  EXPECT_EQ(said(at("pipe")), "is no ordinary file but a pipe");
  EXPECT_EQ(said(folder_), "is no ordinary file but a folder");
  EXPECT_EQ(said("/dev/zero"), "is no ordinary file but a device");
  const int listening = ::socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  at("socket").copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(::bind(listening, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_EQ(said(at("socket")), "is no ordinary file but a socket");
  ::close(listening);
}

TEST_F(OrdinaryFile, WhyItIsNotRead) {
  EXPECT_EQ(not_ordinary("/dev/zero", 10), "is no ordinary file but a device");
  EXPECT_EQ(not_ordinary(at("none"), 10), "") << "its reader says so";
  std::ofstream(at("file")) << "123";
  EXPECT_EQ(not_ordinary(at("file"), 3), "");
  EXPECT_EQ(not_ordinary(at("file"), 2), "has 3 bytes; at most 2 are read");
}

TEST_F(OrdinaryFile, IsNotThereOrTooLarge) {
  EXPECT_EQ(said(at("none")), "cannot be opened: No such file or directory");
  EXPECT_EQ(read_ordinary(at("none"), 1).error().code, ErrorCode::kNotFound);
  std::ofstream(at("file")) << "123";
  EXPECT_EQ(open_ordinary(at("file"), 2).error().message.view(), "has 3 bytes; at most 2 are read");
}

}  // namespace
}  // namespace chimera

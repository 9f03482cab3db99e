// SPDX-License-Identifier: Apache-2.0
#include "chimera/platform/socket_place.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>

#include "chimera/platform/local_socket.h"

namespace chimera {
namespace {

class SocketPlaceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/socket_place_XXXXXX";
    base_ = ::mkdtemp(name);
    folder_ = base_ + "/chimera";
  }
  void TearDown() override { std::filesystem::remove_all(base_); }
  static unsigned mode(const std::string& path) {
    struct stat status {};
    return ::stat(path.c_str(), &status) == 0 ? status.st_mode & 07777u : 0;
  }
  std::string refusal(const std::string& subsystem = "arm") {
    const auto place = SocketPlace::open(folder_, subsystem, false);
    return place ? "" : std::string(place.error().message.view());
  }
  std::string base_, folder_;
};

TEST_F(SocketPlaceTest, ListensForItsUserOnlyAndLeavesNothing) {
  {
    const auto place = SocketPlace::open(folder_, "arm", false);
    ASSERT_TRUE(place.has_value()) << place.error().message.view();
    EXPECT_EQ(place->path(), folder_ + "/arm.sock");
    EXPECT_EQ(mode(folder_), 0700u);
    EXPECT_EQ(mode(place->path()), 0600u);
    int listens = 0;
    socklen_t size = sizeof listens;
    ASSERT_EQ(::getsockopt(place->descriptor(), SOL_SOCKET, SO_ACCEPTCONN, &listens, &size), 0);
    EXPECT_EQ(listens, 1);
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ + "/arm.sock"));
}

TEST_F(SocketPlaceTest, IsOpenToOtherUsersWhenAsked) {
  const auto place = SocketPlace::open(folder_, "arm", true);
  ASSERT_TRUE(place.has_value());
  EXPECT_EQ(mode(folder_), 0711u);
  EXPECT_EQ(mode(place->path()), 0666u);
}

TEST_F(SocketPlaceTest, RefusesARunningSubsystemAndNamesItsProcess) {
  const auto place = SocketPlace::open(folder_, "arm", false);
  EXPECT_EQ(refusal(), "a subsystem 'arm' runs already (process " + std::to_string(::getpid()) +
                           "): end it, or give this one another name");
  EXPECT_EQ(refusal("leg"), "");
}

TEST_F(SocketPlaceTest, ReplacesTheSocketOfADeadKeeper) {
  const pid_t child = ::fork();
  if (child == 0) {
    const auto place = SocketPlace::open(folder_, "arm", false);
    ::_exit(place ? 0 : 1);  // as if killed: nothing is removed
  }
  int status = -1;
  ::waitpid(child, &status, 0);
  ASSERT_EQ(status, 0);
  ASSERT_TRUE(std::filesystem::exists(folder_ + "/arm.sock"));
  EXPECT_EQ(refusal(), "");
}

TEST_F(SocketPlaceTest, RefusesARunningSubsystemWhoseSocketWasRemoved) {
  const std::string process = std::to_string(::getpid());
  {
    const auto place = SocketPlace::open(folder_, "arm", false);
    ASSERT_TRUE(place.has_value());
    std::filesystem::remove(place->path());
    EXPECT_EQ(refusal(), "a subsystem 'arm' runs already (process " + process + "), and its socket was removed: " +
                             "end it by 'kill -INT " + process + "', or give this one another name");
    EXPECT_EQ(refusal("leg"), "");
  }
  EXPECT_EQ(refusal(), "");
}

TEST_F(SocketPlaceTest, IgnoresTheClaimOfAnotherUser) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can become another user";
  const std::string path = folder_ + "/arm.sock";
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const bool holds = ::setuid(12345) == 0 && (new OwnedDescriptor(claim_name(path)))->fd >= 0;
    (void)!::write(ends[1], holds ? "y" : "n", 1);
    for (;;) ::pause();
  }
  char said = 0;
  ASSERT_EQ(::read(ends[0], &said, 1), 1);
  EXPECT_EQ(said, 'y');
  EXPECT_EQ(holder_of_name(path).process, child);
  EXPECT_EQ(refusal(), "");
  ::kill(child, SIGKILL);  // still ours
  ::waitpid(child, nullptr, 0);
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST_F(SocketPlaceTest, DoesNotRemoveAFileInItsPlace) {
  const std::string path = folder_ + "/arm.sock";
  {
    const auto place = SocketPlace::open(folder_, "arm", false);
    ASSERT_TRUE(place.has_value());
    std::filesystem::rename(path, path + ".old");
    ASSERT_EQ(::mkdir(path.c_str(), 0700), 0);
  }
  EXPECT_TRUE(std::filesystem::exists(path));
}

TEST_F(SocketPlaceTest, RefusesAnUnsafeFolder) {
  std::filesystem::create_directory(base_ + "/elsewhere");
  std::filesystem::create_symlink(base_ + "/elsewhere", folder_);
  EXPECT_EQ(refusal(), "the folder of the sockets is no folder, or a symbolic link: remove it");
  EXPECT_FALSE(is_safe_folder(folder_.c_str()));
  std::filesystem::remove(folder_);
  std::filesystem::create_directory(folder_);
  ::chmod(folder_.c_str(), 0770);
  EXPECT_EQ(refusal(), "others may write to the folder of the sockets: run 'chmod 0700 " + folder_ + "'");
  EXPECT_FALSE(is_safe_folder(folder_.c_str()));
  ::chmod(folder_.c_str(), 0700);
  EXPECT_TRUE(is_safe_folder(folder_.c_str()));
  if (::geteuid() != 0) return;  // only root can make another user's folder
  ASSERT_EQ(::chown(folder_.c_str(), 12345, 12345), 0);
  EXPECT_EQ(refusal(), "the folder of the sockets is another user's: set XDG_RUNTIME_DIR to a folder of yours");
  EXPECT_FALSE(is_safe_folder(folder_.c_str()));
}

TEST_F(SocketPlaceTest, OpensTheFolderToOthersUnlessTheyMayListItAlready) {
  const auto mode_after = [this](mode_t before) {
    std::filesystem::create_directory(folder_);
    ::chmod(folder_.c_str(), before);
    const auto place = SocketPlace::open(folder_, "s", true);
    EXPECT_TRUE(place);
    return mode(folder_);
  };
  EXPECT_EQ(mode_after(0700), 0711u);
  EXPECT_EQ(mode_after(0755), 0755u);
  EXPECT_EQ(mode(folder_), 0755u) << "at the end of the socket too";
}

TEST_F(SocketPlaceTest, ClosesTheFolderAfterTheLastSocketThatIsOpenToOthers) {
  auto first = SocketPlace::open(folder_, "a", true);
  auto second = SocketPlace::open(folder_, "b", true);
  const auto own = SocketPlace::open(folder_, "c", false);
  ASSERT_TRUE(first && second && own);
  *first = SocketPlace();
  EXPECT_EQ(mode(folder_), 0711u);
  *second = SocketPlace();
  EXPECT_EQ(mode(folder_), 0700u);
}

TEST_F(SocketPlaceTest, RefusesAPathTooLongForASocket) {
  EXPECT_EQ(refusal(std::string(120, 'x')),
            "the path of the socket is longer than 107 bytes: set XDG_RUNTIME_DIR to a shorter one, or give the "
            "subsystem a shorter name");
}

TEST(SocketFolder, IsTheRuntimeFolderOfTheUserOtherwiseAFolderInTmp) {
  const char* before = std::getenv("XDG_RUNTIME_DIR");
  const std::string kept = before == nullptr ? "" : before;
  ::setenv("XDG_RUNTIME_DIR", "/run/other", 1);
  EXPECT_EQ(socket_folder().view(), "/run/other/chimera");
  ::setenv("XDG_RUNTIME_DIR", "relative", 1);  // not a place
  const std::string user = std::to_string(::geteuid());
  const bool has_given = std::filesystem::is_directory("/run/user/" + user);
  EXPECT_EQ(socket_folder().view(), has_given ? "/run/user/" + user + "/chimera" : "/tmp/chimera-" + user);
  if (before == nullptr)
    ::unsetenv("XDG_RUNTIME_DIR");
  else
    ::setenv("XDG_RUNTIME_DIR", kept.c_str(), 1);
}

}  // namespace
}  // namespace chimera

#pragma once

#include <poll.h>
#include <termios.h>
#include <unistd.h>

namespace veridyn::app {

/// Keys without Enter while it lives, where stdin is a terminal; letters from a pipe otherwise.
class OperatorKeys {
 public:
  OperatorKeys() {
    if (::tcgetattr(STDIN_FILENO, &before_) != 0) return;
    terminal_ = true;
    termios now = before_;
    now.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    ::tcsetattr(STDIN_FILENO, TCSANOW, &now);
  }
  ~OperatorKeys() {
    if (terminal_) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
  }
  OperatorKeys(const OperatorKeys&) = delete;
  OperatorKeys& operator=(const OperatorKeys&) = delete;
  /// The next key; 0 where there is none.
  char next() {
    pollfd one{STDIN_FILENO, POLLIN, 0};
    char key = 0;
    if (ended_ || ::poll(&one, 1, 0) <= 0) return 0;
    if (::read(STDIN_FILENO, &key, 1) <= 0) ended_ = true;
    return key;
  }

 private:
  termios before_{};
  bool terminal_ = false, ended_ = false;
};

}  // namespace veridyn::app

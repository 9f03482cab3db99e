// SPDX-License-Identifier: Apache-2.0
// Decides between the draft and FILE, so that no text of a person is lost without that person's word.
#include "chimera/web/page_draft.h"

namespace chimera::web {

PageDraft::PageDraft(FileNow file, std::optional<KeptText> kept) : file_(std::move(file)) {
  text_ = file_.text;
  base_ = present();
  if (!kept) return;
  text_ = std::move(kept->text);
  base_ = std::move(kept->base);
  is_own_ = true;
  settle();
}

std::optional<KeptText> PageDraft::to_keep() const {
  if (!is_touched()) return std::nullopt;
  return KeptText{text_, is_own_ ? base_ : present()};
}

void PageDraft::see(FileNow file) {
  file_ = std::move(file);
  settle();
  if (!is_own_ && file_.is_read() && is_touched() && !file_.text.empty()) follow();
}

void PageDraft::change(std::string text) {
  if (!is_own_ && file_.problem.empty()) base_ = present();
  is_own_ = true;
  text_ = std::move(text);
  ++version_;
  settle();
}

void PageDraft::written() {
  file_ = {true, text_, ""};
  settle();
}

void PageDraft::keep_file() { follow(); }

void PageDraft::follow() {
  text_ = file_.text;
  ++version_;
  settle();
}

/// The draft is not own once FILE has its text.
void PageDraft::settle() {
  if (!file_.is_read() || is_touched()) return;
  is_own_ = false;
  base_ = text_;
}

}  // namespace chimera::web

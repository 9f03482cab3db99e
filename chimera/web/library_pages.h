// SPDX-License-Identifier: Apache-2.0
// Answers the methods `library`, `sheet`, `document` and `values`: docs/formats/web.md, "Library and documents".
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "chimera/catalogue/library.h"
#include "chimera/control/rpc_response.h"
#include "chimera/web/documents.h"
#include "chimera/web/example_values.h"

namespace chimera::web {

/// The hypertext of the library. Reads files on request. Context: setup; may block on the disk.
class LibraryPages {
 public:
  /// `folder` has docs/, examples/ and library/ (Workplace::documents).
  explicit LibraryPages(const std::string& folder) : documents_(Documents::in(folder)) {}

  Json library(const Library& library) const;
  /// Refuses a component that the library does not have.
  control::RpcResponse sheet(const Library& library, const std::string& component);
  /// Refuses the names that Documents::read() refuses.
  control::RpcResponse document(const std::string& name) const;
  /// Refuses a component that the library does not have, and a port that the component does not have.
  control::RpcResponse values(const Library& library, const std::string& component, const std::string& port);

  const Documents& documents() const noexcept { return documents_; }

 private:
  const std::vector<Example>& examples();

  Documents documents_;
  std::optional<std::vector<Example>> examples_;  // read at the first question
};

/// Works that a data sheet cites: the headings behind "papers.md#", each once.
std::vector<std::string> cited_papers(std::string_view sheet);
/// "38 ns typical, 70 ns worst": the begin of the section Execution time; "" without one.
std::string time_on_sheet(std::string_view sheet);
/// The different words of a text in lower case, of at least three letters, digits or '_', in alphabetical order.
std::string words_of(std::string_view text);

}  // namespace chimera::web

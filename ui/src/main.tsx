// SPDX-License-Identifier: Apache-2.0
// The page.
import { createRoot } from "react-dom/client";

createRoot(document.getElementById("page")!).render(<p>Chimera</p>);

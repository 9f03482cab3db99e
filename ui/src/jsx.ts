// SPDX-License-Identifier: Apache-2.0
// Makes the elements, in place of react/jsx-runtime: each call in the bundle is shorter without the name of its module.
// @ts-ignore: a file of React that has no types
import runtime from "/usr/share/nodejs/react/cjs/react-jsx-runtime.production.min.js";

export const { jsx, jsxs, Fragment } = runtime;

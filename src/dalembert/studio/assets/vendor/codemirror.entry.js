// What the text editor uses of CodeMirror, bundled once into codemirror.js by
//   npm install @codemirror/state@6.7.6 @codemirror/view@6.43.15 @codemirror/commands@6.11.1 @codemirror/language@6.13.1 \
//     @codemirror/lint@6.9.8 @codemirror/autocomplete@6.20.4 @codemirror/search@6.7.2 @codemirror/legacy-modes@6.5.5 esbuild@0.28.2
//   npx esbuild codemirror.entry.js --bundle --minify --format=iife --global-name=CodeMirror --outfile=codemirror.js \
//     --banner:js="/* CodeMirror 6, Copyright 2018-2021 Marijn Haverbeke and others, MIT licence, see codemirror.LICENSE */"
export { EditorState } from "@codemirror/state";
export { EditorView, drawSelection, highlightActiveLine, highlightActiveLineGutter, keymap, lineNumbers } from "@codemirror/view";
export { defaultKeymap, indentWithTab } from "@codemirror/commands";
export { HighlightStyle, StreamLanguage, bracketMatching, indentOnInput, syntaxHighlighting } from "@codemirror/language";
export { lintGutter, setDiagnostics } from "@codemirror/lint";
export { autocompletion, closeBrackets, closeBracketsKeymap, completionKeymap } from "@codemirror/autocomplete";
export { highlightSelectionMatches, searchKeymap } from "@codemirror/search";
export { tags } from "@lezer/highlight";
export { toml } from "@codemirror/legacy-modes/mode/toml";

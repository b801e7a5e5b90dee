// CodeMirror, bundled as one global. Its objects are not checked.

declare const CodeMirror: any;

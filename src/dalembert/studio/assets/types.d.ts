// Types of the messages between the page and the server, see `studio/session.py`.

export interface Problem { level: "error" | "warning" | "info" | "note"; message: string; start: number | null; end: number | null; line: number }
/** The text and the state of its file; `text` is null where the page has it already. */
export interface TextMessage { kind: "text"; revision: number; text: string | null; name: string; path: string; changed: boolean; undo: string; redo: string; document: Document | null }
/** Contents of the file: section → name → entry. */
export type Document = Record<string, Record<string, any> | undefined>;
/** A picture; `page` is its address, empty if there is none. */
export interface PictureMessage { kind: "picture"; number: number; revision: number; live: boolean; page: string; problems?: Problem[]; summary?: string; facts?: Facts }
export interface Facts { degrees_of_freedom?: number; free?: number; redundant?: number; redundancies?: string[] }
export interface NoticeMessage { kind: "notice" | "failure"; text: string }
export interface ConflictMessage { kind: "conflict"; text: string; path: string }
export interface FilesMessage { kind: "files"; folder: string; files: string[]; examples: string[] }
export type Message = FilesMessage | TextMessage | PictureMessage | NoticeMessage | ConflictMessage;
export type Attributes = Record<string, string | boolean | number | ((event: Event) => void) | null | undefined>;
export type Child = Node | string | null | undefined | false;

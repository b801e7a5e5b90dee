// Types of the messages between the page and the server, see `studio/session.py`.

/** A replacement in the text as remedy of a problem. */
export interface Fix { title: string; start: number; end: number; insert: string }
export interface Problem { fixes: Fix[]; level: "error" | "warning" | "info" | "note"; message: string; start: number | null; end: number | null; line: number }
/** The text and the state of its file, whose number `opened` is; `text` is null where the page has it already, and `digest` is its hash. */
export interface TextMessage { kind: "text"; revision: number; opened: number; text: string | null; digest: string; name: string; path: string; changed: boolean; undo: string; redo: string; document: Document | null }
/** Contents of the file: section → name → entry. */
export type Document = Record<string, Record<string, any> | undefined>;
/** A picture; `page` is the address of its data, empty if there is none, and `frame` that of a page without data. */
export interface PictureMessage { kind: "picture"; number: number; revision: number; live: boolean; page: string; frame?: string; problems?: Problem[]; summary?: string; facts?: Facts }
export interface Facts { moving?: string[]; degrees_of_freedom?: number; free?: number; redundant?: number; redundancies?: string[] }
/** A notice; a failure has the kind of the request that was not carried out. */
export interface NoticeMessage { kind: "notice" | "failure"; text: string; request?: string }
export interface ConflictMessage { kind: "conflict"; text: string; path: string; missing: boolean }
export interface Example { example: string; name: string; description: string }
export interface FilesMessage { kind: "files"; folder: string; files: string[]; recent: string[]; examples: Example[] }
/** Progress, or the end of an export; `share` is the part that is done. */
export interface ExportMessage { kind: "export"; number: number; state: "progress" | "done" | "failed" | "stopped"; share?: number; address?: string; name?: string; text?: string; omissions?: string[] }
/** Other assembly configurations: body → x, y and angle. */
export interface AssembliesMessage { kind: "assemblies"; revision: number; poses: Record<string, number[]>[]; text: string }
/** Keys of `[analysis]` that are shown without being written. */
export interface PreviewMessage { kind: "preview"; fields: Record<string, unknown> | null }
/** A candidate of a synthesis; `lines` are places over the instants. */
export interface Card { error: number; distance: number; dimensions: Record<string, number>; marks: string[]; target: number[][]; curve: number[][]; lines: number[][][][]; operations?: Record<string, unknown>[]; parameters?: Record<string, number> }
/** State of a design task; `page` is the address of its result, empty if there is none. */
export interface TaskMessage { kind: "task"; number: number; section: string; digest: string; status: "running" | "done" | "stopped" | "failed"; stopping: boolean; fraction: number | null; history: [number, number][]; text: string; ok: boolean; page: string; designs: Record<string, number>[]; cards: Card[] }
export type Message = FilesMessage | ExportMessage | TextMessage | PictureMessage | NoticeMessage | ConflictMessage;
export type Attributes = Record<string, string | boolean | number | ((event: Event) => void) | null | undefined>;
export type Child = Node | string | null | undefined | false;

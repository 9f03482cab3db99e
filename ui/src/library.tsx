// SPDX-License-Identifier: Apache-2.0
// The library as hypertext: search, the page of each component, and all documents.
import { DragEvent, KeyboardEvent, ReactNode, useEffect, useMemo, useRef, useState } from "react";
import { Button } from "./controls";
import { Around, markdown, Picture } from "./document";
import type { Place } from "./place";
import { PlaceLink } from "./place_link";
import { Found, Library, LibraryComponent, search } from "./search";

/** Type of what is dragged from the list: the name of a component. */
export const DRAGGED = "application/x-chimera-component";

interface Sheet {
  component: string; document: string | null; text: string | null; sources: string[];
  lessons: { document: string; title: string }[];
  fits: { port: string; with: { component: string; port: string }[]; more: number }[];
}
type DocumentText = { name: string; text: string } | { name: string; type: string; base64: string };

export interface LibraryProps {
  /** Calls a method of the bench. */
  call: (method: string, parameters?: object) => Promise<any>;
  place: Place;
  go: (place: Place, replace?: boolean) => void;
  /** Puts a component on the canvas, `at` a port ("TASK PORT") if it was dropped there. Left out: there is none. */
  add?: (component: LibraryComponent, at?: string) => void;
  /** The canvas, which stands beside the search. */
  canvas?: ReactNode;
  close: () => void;
  /** Execution times of a component in what runs. */
  measured: (component: string) => string;
}

/** The answer of a method, asked for again when `what` changes; the reason while there is none. */
function useAnswer<T>(call: LibraryProps["call"], method: string, what: string,
                      parameters: object): [T | null, string] {
  const [answer, set] = useState<[string, T | null, string]>(["", null, ""]);
  useEffect(() => {
    let isNeeded = true;
    call(method, parameters).then((got: T) => { if (isNeeded) set([what, got, ""]); },
      (error: Error) => { if (isNeeded) set([what, null, error.message]); });
    return () => { isNeeded = false; };
  }, [call, method, what]);  // `what` stands for the parameters
  return answer[0] === what ? [answer[1], answer[2]] : [null, ""];
}

const place = (doc: string): Place => ({ doc, at: "" });

function Links({ title, go, links }: { title: string; go: LibraryProps["go"]; links: [string, string][] }) {
  if (links.length === 0) return null;
  return (
    <section aria-label={title}>
      <h2>{title}</h2>
      <ul>{links.map(([doc, name]) => <li key={doc}><PlaceLink to={place(doc)} go={go}>{name}</PlaceLink></li>)}</ul>
    </section>
  );
}

function Fits({ fits, go }: { fits: Sheet["fits"]; go: LibraryProps["go"] }) {
  if (fits.length === 0) return null;
  return (
    <section aria-label="What fits each port">
      <h2>What fits each port</h2>
      <dl>{fits.map((one) => (
        <div key={one.port} data-fits={one.port}>
          <dt><code>{one.port}</code></dt>
          <dd>{one.with.map(({ component, port }) => (
            <span key={`${component} ${port}`}>
              <PlaceLink to={place(`component/${component}`)} go={go}>{component}.{port}</PlaceLink>{" "}
            </span>))}{one.more > 0 && <span className="soft">and {one.more} more</span>}</dd>
        </div>))}</dl>
    </section>
  );
}

function PortTable({ component }: { component: LibraryComponent }) {
  return (
    <table aria-label="Ports">
      <thead><tr>{["port", "kind", "type", "unit", "what it is"].map((cell) => <th key={cell} scope="col">{cell}</th>)}
      </tr></thead>
      <tbody>{component.ports.map((p) => (
        <tr key={p.port}><td><code>{p.port}{p.repeated && "*"}</code></td><td>{p.kind}</td><td>{p.type}{p.shape}</td>
          <td>{p.unit}</td><td>{p.doc}</td></tr>))}</tbody>
    </table>
  );
}

type PageProps = LibraryProps & { around: (base: string) => Around };

function ComponentPage({ component, call, go, add, around, measured }: PageProps & { component: LibraryComponent }) {
  const { name, rate_hz, time } = component;
  const [sheet, why] = useAnswer<Sheet>(call, "sheet", name, { component: name });
  const facts = [rate_hz === null ? "" : `${rate_hz} Hz by default`, component.aperiodic ? "released by events" : "",
    time === null ? "" : `${time} (its sheet)`, measured(name)].filter((fact) => fact !== "");
  return (
    <>
      <p className="acts">{add && <Button label="Put on the canvas" press={() => add(component)} />}
        <span className="soft" data-facts>{facts.join(" · ")}</span></p>
      {why !== "" && <p className="fault">{why}</p>}
      {sheet && (sheet.text !== null ? markdown(sheet.text, around(`library/${name}/README.md`))
        : <><h1>{name}</h1><p>{component.doc}</p><PortTable component={component} /></>)}
      {sheet && <Fits fits={sheet.fits} go={go} />}
      {sheet && <Links title="Lessons" go={go} links={sheet.lessons.map((one) => [one.document, one.title])} />}
      {sheet && <Links title="Code" go={go} links={sheet.sources.map((one) => [one, one])} />}
      <p className="soft">{component.file}</p>
    </>
  );
}

function DocumentPage({ name, call, around }: PageProps & { name: string }) {
  const [document, why] = useAnswer<DocumentText>(call, "document", name, { name });
  if (why !== "") return <p className="fault">{why}</p>;
  if (!document) return <p className="hint">Loading…</p>;
  if (!("text" in document)) return <Picture name={name} alt={name} load={around(name).picture} />;
  return name.endsWith(".md") ? <>{markdown(document.text, around(name))}</>
    : <><h1>{name}</h1><pre><code>{document.text}</code></pre></>;
}

function Row({ found, isChosen, go, add }: { found: Found; isChosen: boolean } & Pick<LibraryProps, "go" | "add">) {
  const { component } = found;
  const drag = (event: DragEvent) => event.dataTransfer.setData(DRAGGED, component?.name ?? "");
  return (
    <li data-found={found.place} aria-current={isChosen || undefined} draggable={component !== undefined}
        onDragStart={drag} onDoubleClick={() => { if (component) add?.(component); }}>
      <PlaceLink to={place(found.place)} go={go}>{found.name}</PlaceLink> <span className="doc">{found.doc}</span>
      {found.why !== "" && <span className="soft"> ({found.why})</span>}
    </li>
  );
}

function Faults({ faults }: { faults: Library["faults"] }) {
  if (faults.length === 0) return null;
  return (
    <details><summary>{faults.length} cannot be read</summary>
      <ul>{faults.map((one) => <li key={one.file} className="fault">{one.file}: {one.message}</li>)}</ul></details>
  );
}

/** Pictures as addresses of data: the page may show nothing else. */
async function pictureOf(call: LibraryProps["call"], name: string): Promise<string> {
  const got: DocumentText = await call("document", { name });
  if ("text" in got) throw new Error(`${name} is no picture`);
  const bytes = Uint8Array.from(atob(got.base64), (letter) => letter.charCodeAt(0));
  return URL.createObjectURL(new Blob([bytes], { type: got.type }));
}

export function LibraryPage(props: LibraryProps) {
  const { call, place: { doc, at }, go, add, canvas, close } = props;
  const [library, why] = useAnswer<Library>(call, "library", "library", {});
  const [query, ask] = useState("");
  const input = useRef<HTMLInputElement>(null);
  const page = useRef<HTMLElement>(null);
  const found = useMemo(() => (library ? search(query, library) : []), [library, query]);
  const around = useMemo(() => {
    const names = new Set(library?.documents.map((one) => one.name));
    const picture = (name: string) => pictureOf(call, name);
    return (base: string): Around => ({ base, isThere: (name) => names.has(name), go, picture });
  }, [library, call, go]);
  useEffect(() => { if (doc === "library") input.current?.focus(); }, [doc]);
  useEffect(() => {  // a heading, once its text is there
    if (!page.current) return;
    const heading = () => (at === "" ? null : document.getElementById(`at-${at}`));
    const observer = new MutationObserver(() => {
      heading()?.scrollIntoView();
      if (heading()) observer.disconnect();
    });
    page.current.scrollTo(0, 0);
    heading()?.scrollIntoView();
    if (at !== "" && !heading()) observer.observe(page.current, { childList: true, subtree: true });
    return () => observer.disconnect();
  }, [doc, at]);
  const component = library?.components.find((one) => `component/${one.name}` === doc);
  const chosen = found.findIndex((one) => one.place === doc);
  const take = (event: KeyboardEvent) => {
    const step = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0;
    const next = found[Math.max(0, Math.min(found.length - 1, chosen + step))];
    if (step !== 0 && next) go(place(next.place), true);
    else if (event.key === "Enter" && (found[chosen] ?? found[0])) {
      const one = (found[chosen] ?? found[0])!;
      if (one.component && add) add(one.component);
      else go(place(one.place));
    } else return;
    event.preventDefault();
  };
  let shown: ReactNode = (
    <p className="hint">A press on a name shows its page{add && "; Enter puts the component on the canvas"}.</p>);
  if (component) shown = <ComponentPage {...props} around={around} component={component} />;
  else if (library && doc.startsWith("component/"))
    shown = <p className="fault">The library has no component '{doc.slice("component/".length)}'.</p>;
  else if (library && doc !== "library") shown = <DocumentPage key={doc} {...props} around={around} name={doc} />;
  const drop = (event: DragEvent) => {
    const one = library?.components.find(({ name }) => name === event.dataTransfer.getData(DRAGGED));
    if (one) add?.(one, (event.target as Element).closest<HTMLElement>("[data-port]")?.dataset["port"]);
    if (one) event.preventDefault();
  };
  const isBeside = canvas !== undefined && doc === "library";
  return (
    <div className="library" onKeyDown={(event) => { if (event.key === "Escape" && !event.defaultPrevented) close(); }}>
      <nav aria-label="Library">
        <p className="acts"><Button label="Close the library" title="Escape" press={close}>Close</Button>
          <PlaceLink to={place("README.md")} go={go}>README</PlaceLink>{" "}
          <PlaceLink to={place("examples/README.md")} go={go}>Lessons</PlaceLink>{" "}
          <PlaceLink to={place("docs/glossary.md")} go={go}>Glossary</PlaceLink></p>
        <input ref={input} id="library-search" type="search" value={query} placeholder="word, port, unit or paper"
               aria-label="Search the library" onChange={(event) => ask(event.target.value)} onKeyDown={take} />
        {why !== "" && <p className="fault">{why}</p>}
        <ul className="found" aria-label="Found">{found.map((one, i) => (
          <Row key={one.place} found={one} isChosen={i === chosen} go={go} add={add} />))}</ul>
        {library && found.length === 0 && <p className="hint">Nothing has all these words.</p>}
        {library && <Faults faults={library.faults} />}
      </nav>
      {isBeside ? <div className="beside" onDragOver={(event) => event.preventDefault()} onDrop={drop}>{canvas}</div>
        : <main><article ref={page} tabIndex={-1} aria-label="Document">{shown}</article></main>}
    </div>
  );
}

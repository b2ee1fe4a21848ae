// A slider with the browser's own range input, which keyboards and screen readers know.
export function render({ model }) {
  const label = document.createElement("label"), name = document.createElement("span");
  const output = document.createElement("output"), input = document.createElement("input");
  label.className = "slider";
  Object.assign(input, { type: "range", min: model.start, max: model.end, step: model.step, value: model.value });
  name.textContent = model.title;
  const write = () => {
    const value = Number(input.value) * model.factor;
    output.textContent = `${Number(value.toPrecision(4))} ${model.unit}`;
    input.setAttribute("aria-valuetext", output.textContent);
  };
  input.addEventListener("input", () => { write(); model.value = Number(input.value); });
  model.on("value", () => { input.value = model.value; write(); });
  write();
  label.append(name, output, input);
  return label;
}

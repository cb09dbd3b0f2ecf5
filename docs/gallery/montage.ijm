// xvfb-run imagej -b montage.ijm STACK.tif,PICTURE.png: sixteen slices of a stack of labels side by side, by ImageJ.
files = split(getArgument(), ",");
open(files[0]);
getDimensions(width, height, channels, slices, frames);
run("RGB Color");
step = floor(slices / 16);
run("Make Montage...", "columns=4 rows=4 scale=1 increment=" + step + " border=4 label");
saveAs("PNG", files[1]);

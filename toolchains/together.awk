# together.awk OUT=… FILE… -- the files as one text in OUT, which says where each line comes from.
FNR == 1 { printf "#line 1 \"%s\"\n", FILENAME > OUT }
{ print > OUT }
